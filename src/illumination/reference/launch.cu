// The reference's rays on GPUs: the same source, one thread a node, or a run of sixteen.
#include "cuda/launch.h"
#include "illumination/reference/launch_gpu.h"

namespace chiaro::kernel {
namespace {

template <class Rays>
struct TraceNode {
    RayKernel<Rays> kernel;
    const NodeColumn* columns;
    CHIARO_DEVICE void operator()(std::int64_t item) const {
        const NodeColumn& column = columns[item / column_nodes];
        const std::int32_t i = std::int32_t(item % column_nodes), row = i / NodeColumn::width;
        const std::int32_t j = row % column_rows, k = row / column_rows;
        if (j < column.rows_y && k < column.rows_z)
            kernel.template operator()<float>(column, i % NodeColumn::width, j, k);
    }
};

template <class Rays>
struct TraceRun {
    HarmonicsKernel<Rays> kernel;
    const NodeRun* runs;
    HarmonicSums* sums;
    CHIARO_DEVICE void operator()(std::int64_t item) const {
        kernel.template operator()<float>(runs[item], sums[item]);
    }
};

}  // namespace

template <class Rays>
void trace_columns(cuda::Stream& stream, const RayKernel<Rays>& kernel, const NodeColumn* columns, std::int64_t count) {
    cuda::launch_items(stream, count * column_nodes, TraceNode<Rays>{kernel, columns});
}
template <class Rays>
void trace_harmonics(cuda::Stream& stream, const HarmonicsKernel<Rays>& kernel, const NodeRun* runs, std::int64_t count,
                     HarmonicSums* sums) {
    cuda::launch_items(stream, count, TraceRun<Rays>{kernel, runs, sums});
}

#define CHIARO_INSTANTIATE(Rays)                                                                             \
    template void trace_columns(cuda::Stream&, const RayKernel<Rays>&, const NodeColumn*, std::int64_t);     \
    template void trace_harmonics(cuda::Stream&, const HarmonicsKernel<Rays>&, const NodeRun*, std::int64_t, \
                                  HarmonicSums*);
CHIARO_INSTANTIATE(CellRays)
CHIARO_INSTANTIATE(InterpolatedRays<std::uint8_t>)
CHIARO_INSTANTIATE(InterpolatedRays<std::uint16_t>)
CHIARO_INSTANTIATE(InterpolatedRays<float>)
#undef CHIARO_INSTANTIATE

}  // namespace chiaro::kernel

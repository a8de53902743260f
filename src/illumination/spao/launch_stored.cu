// Coarser grids, stored levels and sums on GPUs: the same source, one thread a cell or line.
#include "cuda/launch.h"
#include "illumination/spao/launch_gpu.h"

namespace chiaro::kernel {
namespace {

template <class Source>
struct FillCell {
    Source source;
    GridTarget target;

    CHIARO_DEVICE void operator()(std::int64_t item) const {
        const std::int64_t row = item / target.count[0];
        const std::int32_t x = std::int32_t(item % target.count[0]), y = std::int32_t(row % target.count[1]),
                           z = std::int32_t(row / target.count[1]);
        target.to[std::int64_t(z) * target.slice + std::int64_t(y) * target.row + x] = source.at(x, y, z);
    }
};

template <class Kernel>
struct ResultAccess {
    AccessBatch<Kernel> batch;
    CHIARO_DEVICE void operator()(std::int64_t item) const { batch.result(item); }
};

struct SumAlongX {
    SumTable table;
    CHIARO_DEVICE void operator()(std::int64_t item) const { table.along_x(item); }
};
struct SumAlongY {
    SumTable table;
    CHIARO_DEVICE void operator()(std::int64_t item) const { table.along_y(item); }
};
struct SumAlongZ {
    SumTable table;
    CHIARO_DEVICE void operator()(std::int64_t item) const { table.along_z(item); }
};

}  // namespace

template <class Source>
void fill_grid(cuda::Stream& stream, const Source& source, const GridTarget& target) {
    cuda::launch_items(stream, std::int64_t(target.count[0]) * target.count[1] * target.count[2],
                       FillCell<Source>{source, target});
}
template void fill_grid(cuda::Stream&, const OpacityGrid&, const GridTarget&);
template void fill_grid(cuda::Stream&, const EveryOther&, const GridTarget&);
template void fill_grid(cuda::Stream&, const MeanOfEight&, const GridTarget&);
template void fill_grid(cuda::Stream&, const CrossingOfEight&, const GridTarget&);
template void fill_grid(cuda::Stream&, const CornerWeights&, const GridTarget&);
template void fill_grid(cuda::Stream&, const NextNBuffer&, const GridTarget&);

template <class Kernel>
void result_access(cuda::Stream& stream, const AccessBatch<Kernel>& batch, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * BlockPlace::cells, ResultAccess<Kernel>{batch});
}
template void result_access(cuda::Stream&, const AccessBatch<StoredKernel>&, std::int64_t);
template void result_access(cuda::Stream&, const AccessBatch<ExactKernel>&, std::int64_t);

void sum_up(cuda::Stream& stream, const SumTable& table) {
    const std::int32_t* n = table.opacity.count;
    cuda::launch_items(stream, std::int64_t(n[1]) * n[2], SumAlongX{table});
    cuda::launch_items(stream, table.row() * (n[2] + 1), SumAlongY{table});
    cuda::launch_items(stream, table.slice(), SumAlongZ{table});
}

}  // namespace chiaro::kernel

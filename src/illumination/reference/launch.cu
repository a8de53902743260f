// The rays as CUDA sees them: the same source, one thread a node. Compiled wherever nvcc exists.
#include "illumination/reference/harmonics.h"

namespace chiaro::kernel {

template <class Rays>
__global__ void trace_nodes(RayKernel<Rays> kernel, NodeColumn nodes) {
    const std::int32_t lane = std::int32_t(threadIdx.x), j = std::int32_t(blockIdx.x), k = std::int32_t(blockIdx.y);
    if (lane < NodeColumn::width && j < nodes.rows_y && k < nodes.rows_z)
        kernel.template operator()<float>(nodes, lane, j, k);
}

template __global__ void trace_nodes(RayKernel<CellRays>, NodeColumn);
template __global__ void trace_nodes(RayKernel<InterpolatedRays<std::uint8_t>>, NodeColumn);
template __global__ void trace_nodes(RayKernel<InterpolatedRays<std::uint16_t>>, NodeColumn);
template __global__ void trace_nodes(RayKernel<InterpolatedRays<float>>, NodeColumn);

/// One thread a run: its sums are its own.
template <class Rays>
__global__ void trace_harmonics(HarmonicsKernel<Rays> kernel, const NodeRun* runs, std::int32_t count,
                                HarmonicSums* sums) {
    const std::int32_t i = std::int32_t(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < count) kernel.template operator()<float>(runs[i], sums[i]);
}

template __global__ void trace_harmonics(HarmonicsKernel<CellRays>, const NodeRun*, std::int32_t, HarmonicSums*);
template __global__ void trace_harmonics(HarmonicsKernel<InterpolatedRays<std::uint8_t>>, const NodeRun*, std::int32_t,
                                         HarmonicSums*);
template __global__ void trace_harmonics(HarmonicsKernel<InterpolatedRays<std::uint16_t>>, const NodeRun*, std::int32_t,
                                         HarmonicSums*);
template __global__ void trace_harmonics(HarmonicsKernel<InterpolatedRays<float>>, const NodeRun*, std::int32_t,
                                         HarmonicSums*);

}  // namespace chiaro::kernel

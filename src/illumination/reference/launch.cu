// The rays as CUDA sees them: the same source, one thread a node. Compiled wherever nvcc exists.
#include "illumination/reference/kernel.h"

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

}  // namespace chiaro::kernel

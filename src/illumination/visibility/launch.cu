// Sheared sweeps and nodes as CUDA sees them: the same source, one thread a row, one a node where nodes are alone.
// Compiled wherever nvcc exists.
#include "illumination/visibility/node_kernel.h"
#include "illumination/visibility/sheared_kernel.h"

namespace chiaro::kernel {
namespace {

__device__ std::int32_t item() { return std::int32_t(blockIdx.x * blockDim.x + threadIdx.x); }

}  // namespace

/// The rows of one plane.
__global__ void sheared_rows(ShearedKernel kernel, const ShearedRow* rows, std::int32_t count) {
    if (item() < count) kernel.operator()<float>(rows[item()]);
}

__global__ void opacities(OpacityKernel kernel, std::int32_t count) {
    if (item() < count) kernel(item(), 1);
}

__global__ void keep_rows(KeepKernel kernel) {
    const std::int32_t y = item(), z = std::int32_t(blockIdx.y);
    if (y < kernel.count[1] && z < kernel.count[2]) kernel(NodeRow{y, z});
}

__global__ void light_nodes(LightKernel kernel, std::int32_t count) {
    if (item() < count) kernel(item(), 1);
}

}  // namespace chiaro::kernel

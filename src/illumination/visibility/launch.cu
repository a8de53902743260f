// Sheared sweeps and nodes as CUDA sees them: the same source, one thread a row, one a node where nodes are alone.
// Compiled wherever nvcc exists.
#include "illumination/visibility/sheared_kernel.h"

namespace chiaro::kernel {
namespace {

__device__ std::int32_t item() { return std::int32_t(blockIdx.x * blockDim.x + threadIdx.x); }

}  // namespace

/// The rows of one plane.
__global__ void sheared_rows(ShearedKernel kernel, const ShearedRow* rows, std::int32_t count) {
    if (item() < count) kernel.operator()<float>(rows[item()]);
}

}  // namespace chiaro::kernel

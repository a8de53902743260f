// Sweeps with scattering as CUDA sees them: the same source, one thread a row. Compiled wherever nvcc exists.
#include "illumination/transport/sweep_kernel.h"
#include "illumination/transport/update_kernel.h"

namespace chiaro::kernel {
namespace {

__device__ std::int32_t item() { return std::int32_t(blockIdx.x * blockDim.x + threadIdx.x); }

}  // namespace

/// The rows of one plane.
__global__ void first_rows(FirstSweepKernel kernel, const FirstSweepRow* rows, std::int32_t count) {
    if (item() < count) kernel.operator()<float>(rows[item()]);
}

__global__ void source_rows(SourceSweepKernel kernel, const SourceRow* rows, std::int32_t count) {
    if (item() < count) kernel.operator()<float>(rows[item()]);
}

__global__ void update_rows(UpdateKernel kernel, const UpdateRow* rows, std::int32_t count) {
    if (item() < count) kernel.operator()<float>(rows[item()]);
}

}  // namespace chiaro::kernel

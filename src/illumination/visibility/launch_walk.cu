// The walk as CUDA sees it: the same source, one thread a run of sixteen nodes. Compiled wherever nvcc exists.
#include "illumination/visibility/walk_kernel.h"

namespace chiaro::kernel {

/// Runs lie side by side along x; each keeps its sums in `sums`, [run][16][16].
__global__ void walk_runs(WalkKernel kernel, std::int32_t runs_x, std::int32_t runs_y, std::int32_t runs_z,
                          const LaneDirections* directions, std::int32_t direction_count, std::int32_t coefficients,
                          float (*sums)[16][LaneDirections::width]) {
    const std::int32_t run = std::int32_t(blockIdx.x * blockDim.x + threadIdx.x);
    if (run >= runs_x * runs_y * runs_z) return;
    const std::int32_t x = run % runs_x, y = run / runs_x % runs_y, z = run / (runs_x * runs_y);
    walk_run<float>(kernel, {float(x * LaneDirections::width), float(y), float(z)}, directions, direction_count,
                    coefficients, sums[run]);
}

}  // namespace chiaro::kernel

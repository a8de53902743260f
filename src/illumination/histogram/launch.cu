// Half balls around single cells as CUDA sees them: the same source, one thread a cell. Compiled wherever nvcc exists.
#include "illumination/histogram/exact_kernel.h"

namespace chiaro::kernel {

/// Half balls, or whole ones; counts [4][places] of each, zero at first.
__global__ void count_balls(BallView ball, const CellPlaces* cells, const float* gradients, std::int32_t count,
                            bool whole, std::int32_t places, float* counts) {
    const std::int32_t i = std::int32_t(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < count) count_ball(ball, cells[i], gradients + 3 * i, whole, places, counts + std::int64_t(i) * 4 * places);
}

}  // namespace chiaro::kernel

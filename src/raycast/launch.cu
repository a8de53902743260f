// The ray caster's kernel as CUDA sees it: the same source, one thread a pixel. Compiled wherever nvcc exists.
#pragma nv_diag_suppress 549  // "used before its value is set": only where a field glows, and then it is set

#include "illumination/cells/field.h"
#include "illumination/histogram/field.h"
#include "illumination/none/field.h"
#include "illumination/visibility/field.h"
#include "raycast/kernel.h"

namespace chiaro::kernel {

template <class Kernel>
__global__ void raycast_pixels(Kernel kernel, Tile tile, unsigned long long* samples) {
    const std::int32_t x = tile.x0 + std::int32_t(blockIdx.x * blockDim.x + threadIdx.x);
    const std::int32_t y = tile.y0 + std::int32_t(blockIdx.y * blockDim.y + threadIdx.y);
    if (x < tile.x1 && y < tile.y1) atomicAdd(samples, sum(kernel(pixel_block<float>(x, y, tile.x1, tile.y1))));
}

#define CHIARO_INSTANTIATE(Field)                                                                            \
    template __global__ void raycast_pixels(RaycastKernel<std::uint8_t, Field>, Tile, unsigned long long*);  \
    template __global__ void raycast_pixels(RaycastKernel<std::uint16_t, Field>, Tile, unsigned long long*); \
    template __global__ void raycast_pixels(RaycastKernel<float, Field>, Tile, unsigned long long*);
CHIARO_INSTANTIATE(NoneView)
CHIARO_INSTANTIATE(AccessView)
CHIARO_INSTANTIATE(VisibilityView)
CHIARO_INSTANTIATE(HistogramView)

}  // namespace chiaro::kernel

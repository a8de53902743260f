// The path tracer's kernel as CUDA sees it: the same source, one thread a pixel. Compiled wherever nvcc exists.
#include "pathtrace/kernel.h"

namespace chiaro::kernel {

template <class Matter>
__global__ void trace_pixels(PathKernel<Matter> kernel, PathTask task, unsigned long long* collisions) {
    const std::int32_t columns = task.tile.x1 - task.tile.x0;
    const std::int32_t x = std::int32_t(blockIdx.x * blockDim.x + threadIdx.x);
    const std::int32_t y = std::int32_t(blockIdx.y * blockDim.y + threadIdx.y);
    if (x >= columns || y >= task.tile.y1 - task.tile.y0) return;
    const Tile pixel{task.tile.x0 + x, task.tile.y0 + y, task.tile.x0 + x + 1, task.tile.y0 + y + 1};
    const PathTask own{pixel, task.sample, task.results + y * columns + x};
    atomicAdd(collisions, sum(kernel.template operator()<float>(own)));
}

#define CHIARO_INSTANTIATE(Matter)                                                                           \
    template __global__ void trace_pixels(PathKernel<Matter<std::uint8_t>>, PathTask, unsigned long long*);  \
    template __global__ void trace_pixels(PathKernel<Matter<std::uint16_t>>, PathTask, unsigned long long*); \
    template __global__ void trace_pixels(PathKernel<Matter<float>>, PathTask, unsigned long long*);
CHIARO_INSTANTIATE(Cloud)
CHIARO_INSTANTIATE(Surfaces)

}  // namespace chiaro::kernel

// What each launch_*.cu compiles: the ray caster for one kind of field, the same source, one thread a pixel.
#pragma once
#ifdef __CUDACC__
#pragma nv_diag_suppress 549  // "used before its value is set": only where a field glows, and then it is set
#endif
#include "cuda/launch.h"
#include "raycast/launch_gpu.h"

namespace chiaro::kernel {

template <class Kernel>
struct CastPixel {
    Tile tile;
    cuda::Count* samples;
    Kernel kernel;

    CHIARO_DEVICE void operator()(std::int32_t x, std::int32_t y) const {
        cuda::count(samples, y * (tile.x1 - tile.x0) + x,
                    sum(kernel(pixel_block<float>(tile.x0 + x, tile.y0 + y, tile.x1, tile.y1))));
    }
};

template <class Kernel>
void cast_pixels(cuda::Stream& stream, const Kernel& kernel, Tile tile, cuda::Count* samples) {
    cuda::launch_pixels(stream, tile.x1 - tile.x0, tile.y1 - tile.y0, CastPixel<Kernel>{tile, samples, kernel});
}

#define CHIARO_INSTANTIATE(Field)                                                                             \
    template void cast_pixels(cuda::Stream&, const RaycastKernel<std::uint8_t, Field>&, Tile, cuda::Count*);  \
    template void cast_pixels(cuda::Stream&, const RaycastKernel<std::uint16_t, Field>&, Tile, cuda::Count*); \
    template void cast_pixels(cuda::Stream&, const RaycastKernel<float, Field>&, Tile, cuda::Count*);         \
    template void cast_pixels(cuda::Stream&, const RaycastKernel<Texel, Field>&, Tile, cuda::Count*);

}  // namespace chiaro::kernel

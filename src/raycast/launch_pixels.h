// What each launch_*.cu compiles: the ray caster for one kind of field, the same source, one thread a pixel.
#pragma once
#ifdef __CUDACC__
#pragma nv_diag_suppress 549  // "used before its value is set": only where a field glows, and then it is set
#endif
#include "cuda/launch.h"
#include "raycast/launch_card.h"

namespace chiaro::kernel {

template <class Kernel>
struct CastPixel {
    Tile tile;
    SampleCount* samples;
    Kernel kernel;

    CHIARO_ON_CARD void operator()(std::int32_t x, std::int32_t y) const {
        const std::int32_t warp = (y * (tile.x1 - tile.x0) + x) / 32;
        atomicAdd(samples + (warp & (sample_counts - 1)),
                  SampleCount(kernel(pixel_block<float>(tile.x0 + x, tile.y0 + y, tile.x1, tile.y1))));
    }
};

template <class Kernel>
void cast_pixels(cuda::Stream& stream, const Kernel& kernel, Tile tile, SampleCount* samples) {
    cuda::launch_pixels(stream, tile.x1 - tile.x0, tile.y1 - tile.y0, CastPixel<Kernel>{tile, samples, kernel});
}

#define CHIARO_INSTANTIATE(Field)                                                                             \
    template void cast_pixels(cuda::Stream&, const RaycastKernel<std::uint8_t, Field>&, Tile, SampleCount*);  \
    template void cast_pixels(cuda::Stream&, const RaycastKernel<std::uint16_t, Field>&, Tile, SampleCount*); \
    template void cast_pixels(cuda::Stream&, const RaycastKernel<float, Field>&, Tile, SampleCount*);

}  // namespace chiaro::kernel

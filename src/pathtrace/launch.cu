// The path tracer's kernel on GPUs: the same source, one thread a pixel.
#include "cuda/launch.h"
#include "pathtrace/launch_gpu.h"

namespace chiaro::kernel {

template <class Kernel>
struct TracePixel {
    std::int32_t width, sample;
    PixelSum* sums;
    cuda::Count* collisions;
    Kernel kernel;

    CHIARO_DEVICE void operator()(std::int32_t x, std::int32_t y) const {
        const std::int32_t pixel = y * width + x;
        Rgba path{0, 0, 0, 0};
        const auto met = kernel.template operator()<float>(PathTask{{x, y, x + 1, y + 1}, sample, &path});
        sums[pixel].add(path);
        cuda::count(collisions, pixel, met);
    }
};

template <class Kernel>
void trace_frame(cuda::Stream& stream, const Kernel& kernel, std::int32_t width, std::int32_t height,
                 std::int32_t sample, PixelSum* sums, cuda::Count* collisions) {
    cuda::launch_pixels(stream, width, height, TracePixel<Kernel>{width, sample, sums, collisions, kernel});
}

#define CHIARO_INSTANTIATE_FOR(Matter, Voxel)                                                              \
    template void trace_frame(cuda::Stream&, const PathKernel<Matter<Voxel>>&, std::int32_t, std::int32_t, \
                              std::int32_t, PixelSum*, cuda::Count*);
#define CHIARO_INSTANTIATE(Matter)                \
    CHIARO_INSTANTIATE_FOR(Matter, std::uint8_t)  \
    CHIARO_INSTANTIATE_FOR(Matter, std::uint16_t) \
    CHIARO_INSTANTIATE_FOR(Matter, float)
CHIARO_INSTANTIATE(Cloud)
CHIARO_INSTANTIATE(SurfaceCloud)
CHIARO_INSTANTIATE(Surfaces)

}  // namespace chiaro::kernel

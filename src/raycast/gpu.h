// The ray caster on a GPU: one thread a pixel.
#pragma once
#include <chiaro/render.h>

#include <algorithm>

#include "cuda/device_cache.h"
#include "cuda/pixels.h"
#include "raycast/launch_gpu.h"
#include "raycast/pointers.h"

namespace chiaro {

/// `arrays`: all that the kernel points into. The pixels stay there; it may be cancelled after every million rays.
template <class Kernel>
RenderStatistics cast_on_gpu(Kernel kernel, const HostArrays& arrays, int width, int height, cuda::Pixels& pixels,
                             Progress& progress, std::string_view stage = "raycast") {
    cuda::Stream& stream = pixels.stream();
    cuda::Views views(stream, arrays);
    swap_pointers(views, kernel);
    const cuda::Counters samples(stream);
    kernel.frame.pixels = pixels.data();

    constexpr std::int64_t max_rays = 1 << 20;
    const std::int64_t rays_a_row = std::int64_t(width) * kernel.rays_per_pixel;
    const int rows = int(std::clamp<std::int64_t>(max_rays / rays_a_row, 1, height));
    for (int y = 0; y < height; y += rows) {
        if (y > 0) stream.wait(), progress.report(stage, double(y) / height);
        if (progress.cancelled()) return {false, 0, {}};
        kernel::cast_pixels(stream, kernel, {0, y, width, std::min(y + rows, height)}, samples.data());
    }
    return {true, samples.sum(), {}};
}

}  // namespace chiaro

// The ray caster on a card: one thread a pixel.
#pragma once
#include <chiaro/render.h>

#include <algorithm>

#include "cuda/mirror.h"
#include "raycast/launch_card.h"
#include "raycast/pointers.h"

namespace chiaro {

/// `arrays`: all that the kernel points into. The frame comes back when it is done; it may be cancelled after every
/// million rays.
template <class Kernel>
Outcome cast_on_card(cuda::Stream& stream, Kernel kernel, const HostArrays& arrays, Frame& frame, Progress& progress) {
    cuda::Views views(stream, arrays);
    swap_pointers(views, kernel);
    const cuda::Array<kernel::Rgba> pixels(stream, std::size_t(frame.width) * frame.height);
    const cuda::Counters samples(stream);
    kernel.frame.pixels = pixels.data();

    constexpr std::int64_t most_rays = 1 << 20;
    const std::int64_t rays_a_row = std::int64_t(frame.width) * kernel.rays_per_pixel;
    const int rows = int(std::clamp<std::int64_t>(most_rays / rays_a_row, 1, frame.height));
    for (int y = 0; y < frame.height; y += rows) {
        if (y > 0) stream.wait(), progress.report("raycast", double(y) / frame.height);
        if (progress.cancelled()) return {false, 0, {}};
        kernel::cast_pixels(stream, kernel, {0, y, frame.width, std::min(y + rows, frame.height)}, samples.data());
    }

    Outcome outcome;
    outcome.samples = samples.land(frame.rgba.data(), pixels.data(), pixels.size() * sizeof(kernel::Rgba));
    return outcome;
}

}  // namespace chiaro

// A kernel over all tiles of a frame, by the CPU.
#pragma once
#include <chiaro/render.h>

#include <algorithm>
#include <atomic>

#include "core/threads.h"
#include "raycast/bounds.h"
#include "raycast/launch.h"

namespace chiaro {

/// Casts all tiles of the frame. Tiles are independent, so the picture is the same for any number of threads.
template <class Kernel>
RenderStatistics cast_tiles(const Device& device, const Kernel& kernel, const BoundingGeometry* geometry,
                            const Frame& frame, std::string_view stage, Progress& progress) {
    constexpr int edge = kernel::tile_edge;
    const auto tile_function = kernel::raycast_tile_for<Kernel>(device.isa);
    // Of a tile as many rows at a time, in whole blocks of pixels, as have some 8192 rays: a few milliseconds' worth.
    const int rows = std::clamp(8192 / (edge * kernel.rays_per_pixel) & ~3, 4, edge);
    const int tiles_x = (frame.width + edge - 1) / edge, tiles_y = (frame.height + edge - 1) / edge;
    std::atomic<std::int64_t> samples{0};
    const bool complete = parallel_for(
        device.threads, std::int64_t(tiles_x) * tiles_y, 1, stage, progress, [&](std::int64_t t, std::int64_t) {
            const int x = int(t % tiles_x) * edge, y = int(t / tiles_x) * edge;
            const kernel::Tile tile{x, y, std::min(x + edge, frame.width), std::min(y + edge, frame.height)};
            Kernel bounded = kernel;
            TileBounds bounds;
            if (geometry) {
                geometry->rasterise(tile, kernel.rays_per_pixel, bounds);
                bounded.bounds = bounds.view(tile);
            }
            for (int y0 = y; y0 < tile.y1 && !progress.cancelled(); y0 += rows)
                samples += tile_function(bounded, {x, y0, tile.x1, std::min(y0 + rows, tile.y1)});
        });
    return {complete, std::uint64_t(samples)};
}

}  // namespace chiaro

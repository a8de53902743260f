#include <chiaro/error.h>
#include <chiaro/render.h>

#include <algorithm>
#include <atomic>
#include <optional>

#include "core/threads.h"
#include "illumination/lit_field.h"
#include "raycast/background.h"
#include "raycast/bounds.h"
#include "raycast/card.h"
#include "raycast/launch.h"
#include "raycast/views.h"

namespace chiaro {
namespace {

/// Casts all tiles of the frame. Tiles are independent, so the picture is the same for any number of threads.
template <class Kernel>
Outcome cast(const Device& device, const Kernel& kernel, const BoundingGeometry* geometry, const Frame& frame,
             Progress& progress) {
    constexpr int edge = kernel::tile_edge;
    const auto tile_function = kernel::raycast_tile_for<Kernel>(device.isa);
    const int tiles_x = (frame.width + edge - 1) / edge, tiles_y = (frame.height + edge - 1) / edge;
    std::atomic<std::int64_t> samples{0};
    const bool complete = parallel_for(
        device.threads, std::int64_t(tiles_x) * tiles_y, 1, "raycast", progress, [&](std::int64_t t, std::int64_t) {
            const int x = int(t % tiles_x) * edge, y = int(t / tiles_x) * edge;
            const kernel::Tile tile{x, y, std::min(x + edge, frame.width), std::min(y + edge, frame.height)};
            if (!geometry) {
                samples += tile_function(kernel, tile);
                return;
            }
            TileBounds bounds;
            geometry->rasterise(tile, kernel.rays_per_pixel, bounds);
            Kernel bounded = kernel;
            bounded.bounds = bounds.view(tile);
            samples += tile_function(bounded, tile);
        });
    return {complete, std::uint64_t(samples)};
}

/// On the card where the device has one. `arrays`: all that the kernel points into, the field's among them.
template <class Kernel>
Outcome cast(const Device& device, const Kernel& kernel, const HostArrays& arrays, const LitField& lit,
             const BoundingGeometry* geometry, Frame& frame, Progress& progress) {
    Outcome outcome;
    const auto on_card = [&] {
        lit.come_to(*device.stream);
        outcome = cast_on_card(*device.stream, kernel, arrays, frame, progress);
    };
    if (cuda::done_on_card(device, on_card)) return outcome;
    lit.come();
    return cast(device, kernel, geometry, frame, progress);
}

}  // namespace

Outcome raycast(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
                const Camera& camera, const RaySettings& settings, Frame& frame, Progress& progress) {
    const Medium::Data& data = medium.data();
    const LitField lit = lit_field(field, lighting, camera, data);
    const RayTables tables = make_tables(data, settings, device.threads, lit.albedo_limit);
    std::optional<BoundingGeometry> geometry;  // the largest value is looked for everywhere; a card takes the box
    if (settings.ray_setup == RaySetup::raster && data.shape.mode != Mode::mip && !cuda::works(device))
        geometry.emplace(data, camera_view(camera, data.volume.geometry(), frame.width, frame.height));
    HostArrays arrays = lit.arrays;
    data.add_to(arrays);
    tables.add_to(arrays);
    Outcome outcome = std::visit(
        [&](auto view) {
            if constexpr (decltype(view)::adds_opacity) {
                view.step_edges = float(settings.step_voxels);
                if (view.glows) geometry.reset();  // light shines where nothing is
            }
            return with_stored_voxel(data.volume.data(), [&](auto voxel) {
                auto kernel = make_kernel<decltype(voxel)>(data, tables, view, lighting, camera, settings, frame,
                                                           lit.albedo_limit);
                if (lit.main) shine_from(*lit.main, lighting, camera, kernel.matter.shading);
                if constexpr (decltype(view)::adds_opacity)
                    if (view.glows) kernel.matter.occupancy.cells = view.occupancy;
                return cast(device, kernel, arrays, lit, geometry ? &*geometry : nullptr, frame, progress);
            });
        },
        lit.view);
    if (lighting.probe.background && outcome.complete)
        outcome.complete = put_probe_behind(device, lighting, camera, data.shape.color, frame, progress);
    return outcome;
}

}  // namespace chiaro

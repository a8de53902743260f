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

/// Of what fills either a frame or, where a card does, `pixels` there.
struct Filled {
    Frame& frame;
    std::shared_ptr<cuda::Pixels> pixels;

    /// To the host, where the card has them.
    void bring() {
        if (pixels) pixels->bring_to(frame.rgba.data());
        pixels.reset();
    }
};

/// On the card where the device has one.
template <class Kernel>
Outcome cast(const Device& device, const Kernel& kernel, const HostArrays& arrays, const BoundingGeometry* geometry,
             Filled& filled, Progress& progress) {
    const auto [width, height] = std::pair(filled.frame.width, filled.frame.height);
    Outcome outcome;
    const auto on_card = [&] {
        const auto pixels = std::make_shared<cuda::Pixels>(device.stream, std::size_t(width) * height);
        outcome = cast_on_card(kernel, arrays, width, height, *pixels, progress);
        filled.pixels = pixels;
    };
    return cuda::done_on_card(device, on_card) ? outcome : cast(device, kernel, geometry, filled.frame, progress);
}

/// Where the pixels are.
bool put_probe_behind(const Device& device, const Lighting& lighting, const Camera& camera, ColorMode color,
                      Filled& filled, Progress& progress) {
    Frame& frame = filled.frame;
    const auto on_card = [&] { put_probe_behind(*filled.pixels, lighting, camera, color, frame.width, frame.height); };
    if (filled.pixels && cuda::done_on_card(device, on_card)) return !progress.cancelled();
    filled.bring();
    return put_probe_behind(device, lighting, camera, color, frame, progress);
}

Outcome fill(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
             const Camera& camera, const RaySettings& settings, Filled& filled, Progress& progress) {
    Frame& frame = filled.frame;
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
                return cast(device, kernel, arrays, geometry ? &*geometry : nullptr, filled, progress);
            });
        },
        lit.view);
    if (lighting.probe.background && outcome.complete)
        outcome.complete = put_probe_behind(device, lighting, camera, data.shape.color, filled, progress);
    return outcome;
}

}  // namespace

Outcome raycast(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
                const Camera& camera, const RaySettings& settings, Frame& frame, Progress& progress) {
    Filled filled{frame, nullptr};
    const Outcome outcome = fill(device, medium, field, lighting, camera, settings, filled, progress);
    filled.bring();
    return outcome;
}

Outcome raycast(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
                const Camera& camera, const RaySettings& settings, DeviceFrame& frame, Progress& progress) {
    Filled filled{frame.write(), nullptr};
    const Outcome outcome = fill(device, medium, field, lighting, camera, settings, filled, progress);
    frame.keep_on_card(std::move(filled.pixels));
    return outcome;
}

}  // namespace chiaro

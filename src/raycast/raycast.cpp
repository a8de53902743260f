#include <chiaro/error.h>
#include <chiaro/render.h>

#include <algorithm>
#include <atomic>

#include "core/threads.h"
#include "illumination/field.h"
#include "raycast/launch.h"
#include "raycast/views.h"

namespace chiaro {
namespace {

constexpr int tile_edge = 32;

/// Casts all tiles of the frame. Tiles are independent, so the picture is the same for any number of threads.
template <class Kernel>
Outcome cast(const Device& device, const Kernel& kernel, const Frame& frame, Progress& progress) {
    const auto tile_function = kernel::raycast_tile_for<Kernel>(device.isa);
    const int tiles_x = (frame.width + tile_edge - 1) / tile_edge, tiles_y = (frame.height + tile_edge - 1) / tile_edge;
    std::atomic<std::int64_t> samples{0};
    const bool complete = parallel_for(
        device.threads, std::int64_t(tiles_x) * tiles_y, 1, "raycast", progress, [&](std::int64_t t, std::int64_t) {
            const int x = int(t % tiles_x) * tile_edge, y = int(t / tiles_x) * tile_edge;
            samples += tile_function(
                kernel, {x, y, std::min(x + tile_edge, frame.width), std::min(y + tile_edge, frame.height)});
        });
    return {complete, std::uint64_t(samples)};
}

/// Calls f with a value of the stored voxel type.
template <class Function>
Outcome with_stored_type(VoxelType stored, Function&& f) {
    switch (stored) {
        case VoxelType::u8:
            return f(std::uint8_t{});
        case VoxelType::u16:
            return f(std::uint16_t{});
        default:
            return f(float{});
    }
}

}  // namespace

Outcome raycast(const Device& device, const Medium& medium, const IlluminationField& field, const Lighting& lighting,
                const Camera& camera, const RaySettings& settings, Frame& frame, Progress& progress) {
    const Medium::Data& data = medium.data();
    const RayTables tables = make_tables(data, settings, device.threads);
    return std::visit(
        [&](const auto& view) {
            return with_stored_type(data.volume.data().stored, [&](auto voxel) {
                return cast(device, make_kernel<decltype(voxel)>(data, tables, view, lighting, camera, settings, frame),
                            frame, progress);
            });
        },
        field.data().view);
}

}  // namespace chiaro

#include "raycast/shared_values.h"

#include <algorithm>

#include "raycast/cast.h"
#include "raycast/value_kernel.h"

namespace chiaro {
namespace {

/// Every fourth number, from the `channel`th on.
std::vector<float> plane_of(const Frame& frame, std::size_t channel) {
    std::vector<float> plane(frame.rgba.size() / 4);
    for (std::size_t p = 0; p < plane.size(); ++p) plane[p] = frame.rgba[4 * p + channel];
    return plane;
}

/// Stored values of the whole rays, and whether they are in the volume at all (1 or 0).
struct Values {
    std::vector<float> value, seen;
};

Values extremes(Exchange& ranks, const Frame& frame, bool is_largest) {
    Values found{plane_of(frame, 0), plane_of(frame, 3)};
    for (std::size_t p = 0; p < found.value.size(); ++p)
        if (found.seen[p] == 0) found.value[p] = is_largest ? -3e38f : 3e38f;
    if (is_largest)
        ranks.largest(found.value);
    else
        ranks.smallest(found.value);
    ranks.largest(found.seen);
    return found;
}

Values means(Exchange& ranks, const Frame& frame) {
    Values found{plane_of(frame, 0), plane_of(frame, 1)};
    ranks.sum(found.value), ranks.sum(found.seen);
    for (std::size_t p = 0; p < found.value.size(); ++p) {
        found.value[p] /= std::max(found.seen[p], 1e-30f);
        found.seen[p] = found.seen[p] > 0 ? 1.0f : 0.0f;
    }
    return found;
}

}  // namespace

RenderStatistics cast_values(const Device& device, const Medium::Data& medium, const RayTables& tables,
                             const Camera& camera, const RaySettings& settings, Frame& frame, Progress& progress) {
    return with_stored_voxel(medium.volume.data(), [&](auto voxel) {
        using Voxel = decltype(voxel);
        const kernel::ValueKernel<Voxel> kernel{make_kernel<Voxel>(
            medium, tables, kernel::NoneView(), {.shading = Shading::none}, camera, settings, frame, false)};
        return cast_tiles(device, kernel, nullptr, frame, "raycast", progress);
    });
}

void join_values(const Device& device, const Medium::Data& medium, const RayTables& tables, Frame& frame) {
    Exchange alone;
    Exchange& ranks = device.is_shared() ? *device.ranks : alone;
    const Mode mode = medium.shape.mode;
    if (mode == Mode::additive) {
        ranks.sum(std::span<float>(frame.rgba));
        for (std::size_t a = 3; a < frame.rgba.size(); a += 4) frame.rgba[a] = std::min(frame.rgba[a], 1.0f);
        return;
    }
    const bool is_largest = extreme_view(medium.volume.data(), mode).sign > 0;
    const Values found = mode == Mode::mean ? means(ranks, frame) : extremes(ranks, frame, is_largest);
    const kernel::StepTableView table = step_table_view(medium.table, tables);
    auto* pixels = reinterpret_cast<kernel::Rgba*>(frame.rgba.data());
    for (std::size_t p = 0; p < found.value.size(); ++p)
        pixels[p] = found.seen[p] > 0 ? table.at<float>(found.value[p]) : kernel::Rgba{0, 0, 0, 0};
}

}  // namespace chiaro

#include "decode/vtk_arrays.h"

#include "decode/output.h"
#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>

namespace chiaro::decode {

std::size_t choose_array(const std::vector<VtkArray>& arrays, Volume& volume) {
    const auto rank = [](const VtkArray& a) { return 2 * int(a.of_cells) + int(!a.active); };
    const auto best =
        std::min_element(arrays.begin(), arrays.end(), [&](auto& a, auto& b) { return rank(a) < rank(b); });
    if (best == arrays.end()) refuse("holds no array of values for its points or cells");
    std::string others;
    for (const auto& array : arrays)
        if (&array != &*best)
            others += fmt::format("{}'{}'{}", others.empty() ? "" : ", ", array.name, array.of_cells ? " (cells)" : "");
    if (!others.empty()) volume.notes.push_back(fmt::format("shows the array '{}'; also here: {}", best->name, others));
    if (!best->name.empty()) volume.key_values["array"] = best->name;
    return std::size_t(best - arrays.begin());
}

std::array<std::int64_t, 3> set_place(const VtkPlace& place, Volume& volume) {
    constexpr double farthest = 1e9;
    if (place.extent.size() != 6) refuse(fmt::format("its WholeExtent has {} numbers, not 6", place.extent.size()));
    if (place.origin.size() != 3 || place.spacing.size() != 3 || place.direction.size() != 9)
        refuse("its Origin, Spacing and Direction are not 3, 3 and 9 numbers");
    std::array<std::int64_t, 3> points{};
    Vec3 first;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double begin = place.extent[2 * axis], end = place.extent[2 * axis + 1];
        if (!(begin >= -farthest && end <= farthest)) refuse("its WholeExtent is beyond a thousand million");
        if (begin > end) refuse("its WholeExtent makes no sense");
        points[axis] = std::int64_t(end) - std::int64_t(begin) + 1;
        first[int(axis)] = begin;
        volume.geometry.spacing_mm[int(axis)] = place.spacing[axis];
        volume.geometry.direction[axis] = {place.direction[axis], place.direction[3 + axis], place.direction[6 + axis]};
    }
    volume.geometry.origin_mm = {place.origin[0], place.origin[1], place.origin[2]};
    check_geometry(volume.geometry);
    volume.geometry.origin_mm = volume.geometry.world_from_voxel(first);
    return points;
}

std::uint64_t set_shape(const VtkArray& array, const std::array<std::int64_t, 3>& points, Volume& volume) {
    auto n = points;
    if (array.of_cells) {
        Vec3 half;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (n[axis] < 2) continue;  // flat: the cells lie in the plane of the points
            --n[axis];
            half[int(axis)] = 0.5;
        }
        volume.geometry.origin_mm = volume.geometry.world_from_voxel(half);
    }
    volume.type = array.type;
    const auto bytes = checked_bytes(n, array.components, array.type);
    volume.dimensions = {int(n[0]), int(n[1]), int(n[2])};
    volume.components = int(array.components);
    const bool can_be_colors = array.components == 3 || array.components == 4;
    volume.has_own_colors = can_be_colors && (array.are_colors || are_colors_untold(volume));
    return bytes;
}

}  // namespace chiaro::decode

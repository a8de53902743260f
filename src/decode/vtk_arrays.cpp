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

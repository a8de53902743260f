#include "io/lattice.h"

#include <algorithm>

namespace chiaro {
namespace {

Lattice halved(const Lattice& finer, const Geometry& geometry) {
    Lattice lattice = finer;
    for (int axis = 0; axis < 3; ++axis) {
        if (geometry.spacing_mm[axis] >= 2 * geometry.smallest_spacing_mm()) continue;
        lattice.stride[std::size_t(axis)] *= 2;
        lattice.first[std::size_t(axis)] = lattice.stride[std::size_t(axis)] / 2;
    }
    return lattice;
}

}  // namespace

std::vector<ThinnedLevel> thinned(const SourceLevel& grid) {
    std::vector<ThinnedLevel> levels{{grid, {}}};
    for (;;) {
        const auto& [last, finer] = levels.back();
        if (*std::max_element(last.dimensions.begin(), last.dimensions.end()) < 2 * least_level_edge) return levels;
        const Lattice lattice = halved(finer, last.geometry);
        SourceLevel level;
        Vec3 first, stride;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int n = grid.dimensions[axis], at = lattice.first[axis], by = lattice.stride[axis];
            level.dimensions[axis] = at < n ? (n - 1 - at) / by + 1 : 0;
            first[int(axis)] = at, stride[int(axis)] = by;
        }
        if (std::count(level.dimensions.begin(), level.dimensions.end(), 0)) return levels;
        level.geometry = every(grid.geometry, stride, first);
        levels.push_back({level, lattice});
    }
}

Volume kept_header(const Volume& file) {
    Volume kept;
    kept.dimensions = file.dimensions, kept.geometry = file.geometry;
    kept.type = size_of(file.type) <= 2 ? file.type : VoxelType::f32;
    kept.slope = file.slope, kept.intercept = file.intercept;
    kept.source = file.source, kept.format = file.format, kept.modality = file.modality;
    kept.moments = file.moments, kept.notes = file.notes, kept.key_values = file.key_values;
    return kept;
}

}  // namespace chiaro

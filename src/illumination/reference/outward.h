// Where the surface at a cell faces, and how surely: what tells ambient occlusion from obscurance.
#pragma once
#include "illumination/cells/opacity.h"
#include "illumination/cells/outward.h"

namespace chiaro {

struct Outward {
    Vec3 normal;       ///< n, unit; 0 where there is none
    double share = 0;  ///< q of `outward_share`, of the answer that looks along n
};

/// n = -(α(i + 1) - α(i - 1)) per axis, α outside the grid 0.
inline Outward outward_at(const CellValues& opacity, int x, int y, int z, double normal_factor) {
    const auto alpha = [&](int i, int j, int k) {
        const auto [nx, ny, nz] = opacity.grid.count;
        const bool inside = i >= 0 && i < nx && j >= 0 && j < ny && k >= 0 && k < nz;
        return inside ? opacity.data()[opacity.grid.index(i, j, k)] / double(cell_one) : 0;
    };
    const Vec3 n{alpha(x - 1, y, z) - alpha(x + 1, y, z), alpha(x, y - 1, z) - alpha(x, y + 1, z),
                 alpha(x, y, z - 1) - alpha(x, y, z + 1)};
    const double size = length(n);
    if (size == 0) return {};
    const kernel::Vec3<float> steps{float(n.x), float(n.y), float(n.z)};
    return {(1 / size) * n, double(kernel::outward_share(steps, float(normal_factor)))};
}

}  // namespace chiaro

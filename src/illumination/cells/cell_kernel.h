// Where cells lie among the voxels, and which of them are clipped away.
#pragma once
#include "volume/view.h"

namespace chiaro::kernel {

/// A share in [0, 1] as 65535ths.
CHIARO_INLINE std::uint16_t share_value(double share) {
    return std::uint16_t((share < 0 ? 0 : share < 1 ? share : 1) * 65535 + 0.5);
}

/// One voxel, its neighbours brick_row and brick_slice away. The last of an axis lies behind its last interval.
template <class Voxel>
CHIARO_INLINE const Voxel* voxel_address(const VolumeView<Voxel>& volume, std::int32_t x, std::int32_t y,
                                         std::int32_t z) {
    const VoxelIndex<float> i{min(x, volume.last_x), min(y, volume.last_y), min(z, volume.last_z)};
    return volume.voxels + std::uint32_t(volume.template locate<float>({0, 0, 0}, i).index) + (x - i.x) +
           (y - i.y) * brick_row + (z - i.z) * brick_slice;
}

struct CellCentres {
    static constexpr int max_planes = 12;  ///< a clip box's and a clip's own
    struct Plane {
        double x, y, z, d;  ///< n · p > d is clipped away
    };
    double voxels_per_cell[3];
    Plane planes[max_planes];
    std::int32_t plane_count, are_voxels;  ///< not 0: cells are voxels

    /// Voxel coordinate of a centre; cells and voxels both cover [-½, n - ½] of their index.
    CHIARO_INLINE double along(int axis, std::int32_t cell) const { return (cell + 0.5) * voxels_per_cell[axis] - 0.5; }
    CHIARO_INLINE Vec3<float> of(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return {float(along(0, x)), float(along(1, y)), float(along(2, z))};
    }
    CHIARO_INLINE bool is_clipped(std::int32_t x, std::int32_t y, std::int32_t z) const {
        for (std::int32_t i = 0; i < plane_count; ++i) {
            const Plane& n = planes[i];
            if (n.x * along(0, x) + n.y * along(1, y) + n.z * along(2, z) > n.d) return true;
        }
        return false;
    }
};

/// Extinction per mm in a cell's middle, and colour times it; of mixtures.
template <class Voxel>
CHIARO_INLINE Rgba matter_of_cell(const VolumeView<Voxel>& volume, const CellCentres& cells, std::int32_t x,
                                  std::int32_t y, std::int32_t z) {
    const Vec3<float> p = volume.clamp(cells.of(x, y, z));
    return volume.matter_at(volume.template locate<float>(p, volume.voxel(p)));
}

/// What opacity by gradient leaves of a cell's extinction, by its middle.
template <class Voxel>
CHIARO_INLINE float factor_of_cell(const VolumeView<Voxel>& volume, const CellCentres& cells, std::int32_t x,
                                   std::int32_t y, std::int32_t z) {
    if (!volume.has_factor()) return 1;
    const Vec3<float> p = volume.clamp(cells.of(x, y, z));
    const Location<float> at = volume.locate(p, volume.voxel(p));
    return volume.factor_at(at, volume.value(at));
}

}  // namespace chiaro::kernel

// How much light one cell stops: one item is a cell.
#pragma once
#include "illumination/cells/block_place.h"
#include "illumination/cells/cell_kernel.h"
#include "illumination/cells/value_row.h"

namespace chiaro::kernel {

/// Of isosurfaces: how much of a cell lies inside.
struct CoverageView {
    static constexpr int max_surfaces = 8;
    float values[max_surfaces], opacities[max_surfaces];  ///< stored values
    std::int32_t count;
    float inwards;    ///< -1 where stored values fall as values rise
    Float3 per_edge;  ///< voxels
    template <class F>
    CHIARO_INLINE F slope(Vec3<F> gradient) const {
        const Vec3<F> g{gradient.x * F(per_edge.x), gradient.y * F(per_edge.y), gradient.z * F(per_edge.z)};
        return sqrt(dot(g, g));
    }
    /// α = clamp(½ + (f - iso) / (|∇f| e), 0, 1), times the surface's opacity.
    /// `left`: the most that lies inside.
    template <class F>
    CHIARO_INLINE F opacity(F value, F slope, F left) const {
        const Mask<F> slopes = slope > F(0);
        F clear(1);
        for (std::int32_t s = 0; s < count; ++s) {
            const F above = F(inwards) * (value - F(values[s]));
            const F share = max(min(F(0.5f) + above / select(slopes, slope, F(1)), F(1)), F(0));
            const F inside = select(slopes, share, select(above >= F(0), F(1), F(0)));
            clear *= F(1) - F(opacities[s]) * min(inside, left);
        }
        return F(1) - clear;
    }
    /// Whether values in such a range lie so far from each surface that nothing is inside in part, whatever gradient
    /// the range allows (half of it along each axis), rounding included.
    CHIARO_INLINE bool is_passed_by(float low, float high, bool near_surface) const {
        const float steepest = near_surface ? slope(Vec3<float>{high - low, high - low, high - low}) * 0.5f : 0;
        const float far = 0.501f * steepest + 1e-5f * max(abs(low), abs(high));
        for (std::int32_t s = 0; s < count; ++s)
            if (low - far <= values[s] && values[s] <= high + far) return false;
        return true;
    }
};

template <class Voxel>
struct CellOpacityKernel {
    VolumeView<Voxel> volume;
    CellCentres cells;
    const std::uint16_t* entries;  ///< of the optical table; null: isosurfaces
    float scale, offset, last;     ///< index = stored * scale + offset, rounding included
    CoverageView surfaces;
    float edge_mm;     ///< of a cell
    LabelView labels;  ///< that cut isosurfaces; null: none

    CHIARO_INLINE std::int32_t entry_of(float stored) const {
        return std::int32_t(min(max(mad(stored, scale, offset), 0.0f), last));
    }
    CHIARO_INLINE std::uint16_t of_stored(float stored) const { return entries[entry_of(stored)]; }
    // But for clipping:
    CHIARO_INLINE std::uint16_t of_voxel(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (volume.is_mixed()) return of_mixture(x, y, z);
        if (volume.has_factor()) return by_gradient(float(*voxel_address(volume, x, y, z)), x, y, z);
        return of_stored(float(*voxel_address(volume, x, y, z)));
    }
    CHIARO_INLINE std::uint16_t between_voxels(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (volume.is_mixed()) return of_mixture(x, y, z);
        const float stored = volume.value(located(x, y, z));
        return volume.has_factor() ? by_gradient(stored, x, y, z) : of_stored(stored);
    }
    /// Nothing is seen inside a surface, but it is matter.
    CHIARO_INLINE std::uint16_t inside(std::int32_t x, std::int32_t y, std::int32_t z, bool near_surface) const {
        const Location<float> at = located(x, y, z);
        const float left = labels.distance ? left_at(distance_at(labels, at)) : 1;
        return share_value(
            surfaces.opacity<float>(volume.value(at), near_surface ? surfaces.slope(volume.gradient(at)) : 0, left));
    }
    /// The same of a row of points without labels, as shares.
    template <class F>
    CHIARO_INLINE void find_inside(const ValueRow& row, bool near_surface) const {
        for (std::int32_t i = 0; i < row.count; i += LaneTraits<F>::count) {
            const Location<F> at = row.located<F>(volume, i);
            const F slope = near_surface ? surfaces.slope(volume.own_gradient(at)) : F(0);
            store_row(row.to + i, surfaces.opacity(volume.value(at), slope, F(1)));
        }
    }
    CHIARO_INLINE std::uint16_t unclipped(std::int32_t x, std::int32_t y, std::int32_t z, bool near_surface) const {
        if (!entries) return inside(x, y, z, near_surface);
        return cells.are_voxels ? of_voxel(x, y, z) : between_voxels(x, y, z);
    }

private:
    CHIARO_INLINE std::uint16_t of_mixture(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return share_value(1 - exp2(-1.442695041f * edge_mm * matter_of_cell(volume, cells, x, y, z).a));
    }
    CHIARO_INLINE std::uint16_t by_gradient(float stored, std::int32_t x, std::int32_t y, std::int32_t z) const {
        const std::uint16_t all = of_stored(stored);
        if (all == 0) return 0;
        return share_value(opacity_of_share(float(all) / 65535, volume.factor_at(located(x, y, z), stored)));
    }
    CHIARO_INLINE Location<float> located(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const Vec3<float> p = volume.clamp(cells.of(x, y, z));
        return volume.locate(p, volume.voxel(p));
    }
};

/// The same for many threads, a cell each of blocks side by side.
template <class Voxel>
struct OpacityBatch {
    CellOpacityKernel<Voxel> kernel;
    const BlockPlace* places;
    std::int32_t count[3], near_surface;  ///< cells; not 0: something is seen near
    std::uint16_t* out;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockCell its(places, item);
        const std::int32_t x = its.grid_x(), y = its.grid_y(), z = its.grid_z();
        if (x >= count[0] || y >= count[1] || z >= count[2] || kernel.cells.is_clipped(x, y, z)) return;
        out[(std::int64_t(z) * count[1] + y) * count[0] + x] = kernel.unclipped(x, y, z, near_surface != 0);
    }
};

}  // namespace chiaro::kernel

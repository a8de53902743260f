// Regions of the volume with the largest extinction that a path can meet in them.
#pragma once
#include "kernel/gather.h"
#include "pathtrace/path.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// The low bits of a cell's majorant hold how far its region reaches, in cells; the majorant is rounded up to what is
/// left.
inline constexpr std::int32_t reach_mask = 127;
inline constexpr std::int32_t by_voxel = 127;  ///< no reach: each voxel interval of the cell is a region of its own

/// The largest entry of a table between two, both included: from two runs of a power of two, which are all stored
/// (Bender and Farach-Colton 2000).
struct RangeMaximumView {
    const float* runs;  ///< [level][first]: of 2^level entries
    std::int32_t count;

    template <class F>
    CHIARO_INLINE F between(Int<F> first, Int<F> last) const {
        const Int<F> level = (bits_of(to_float(last - first + Int<F>(1))) >> Int<F>(23)) - Int<F>(127);
        const Int<F> row = level * Int<F>(count), length = Int<F>(1) << level;
        return max(gather_float(runs, row + first), gather_float(runs, row + last + Int<F>(1) - length));
    }
};

/// For each 4³ cell a cube of cells around it and the largest extinction in that cube (majorants.h), so that a path
/// crosses what is empty or even in few steps and meets what varies with majorants that are tight. Where matter is so
/// dense that a cell would be met again and again in vain, the values around each voxel interval bound it.
struct RegionsView {
    const float* cells;  ///< majorant per mm and reach; x fastest
    std::int32_t cells_x, cells_y;
    float nudge;  ///< voxels: what rounding can move a point by
    float nudge_mm;
    // For intervals of voxels.
    RangeMaximumView extinction;  ///< per mm, over the optical table
    float scale, offset, last;    ///< entry = stored * scale + offset
    float beyond;                 ///< of the values' size, in entries: what rounding adds to interpolated ones

    /// For the lanes that have left the region they knew: the next one, and where the way leaves it. A point is looked
    /// up a little ahead on every axis, so that a way along a border between cells never stands still.
    template <class F, class Voxel>
    CHIARO_INLINE void enter(const VolumeView<Voxel>& volume, Mask<F> lost, Path<F>& path) const {
        using I = Int<F>;
        const auto ahead = [&](F d) CHIARO_INLINE_LAMBDA { return select(d < F(0), F(-nudge), F(nudge)); };
        const Vec3<F> d = path.direction, p = mad(path.t, d, path.origin);
        const VoxelIndex<F> voxel = volume.voxel(volume.clamp(p + Vec3<F>{ahead(d.x), ahead(d.y), ahead(d.z)}));
        const I x = voxel.x >> I(cell_bits), y = voxel.y >> I(cell_bits), z = voxel.z >> I(cell_bits);
        const I code = bits_of(gather_float(cells, (z * I(cells_y) + y) * I(cells_x) + x));
        const I reach = code & I(reach_mask);
        const Mask<F> fine = reach == I(by_voxel);
        const auto exit = [&](I i, I cell, F origin, F inverse, float end) CHIARO_INLINE_LAMBDA {
            const I low = select(fine, i, (cell - reach) << I(cell_bits)),
                    high = select(fine, i + I(1), (cell + reach + I(1)) << I(cell_bits));
            return (bound<F>(low, high, inverse > F(0), end) - origin) * inverse;
        };
        const F leave = min(exit(voxel.x, x, path.origin.x, path.inverse.x, volume.last.x),
                            min(exit(voxel.y, y, path.origin.y, path.inverse.y, volume.last.y),
                                exit(voxel.z, z, path.origin.z, path.inverse.z, volume.last.z)));
        F majorant = float_of(code & I(~reach_mask));
        if (any(lost & fine)) majorant = select(fine, largest_around(volume, voxel), majorant);
        path.majorant = select(lost, majorant, path.majorant);
        path.leave = select(lost, min(max(leave, path.t + F(nudge_mm)), path.end), path.leave);
    }

private:
    /// The side of a region that lies ahead. The outermost go on beyond the volume's border.
    template <class F>
    static CHIARO_INLINE F bound(Int<F> low, Int<F> high, Mask<F> climbs, float end) {
        const F from = to_float(low), to = to_float(high);
        return select(climbs, select(to >= F(end), F(end + 1), to), select(from <= F(0), F(-1), from));
    }

    /// The largest extinction between the smallest and the largest value of a voxel interval.
    template <class F, class Voxel>
    CHIARO_INLINE F largest_around(const VolumeView<Voxel>& volume, const VoxelIndex<F>& voxel) const {
        const auto [low, high] = volume.range(voxel);
        const F rounding = mad(max(abs(low), abs(high)), F(beyond), F(1.0f / 256));
        const F reach = select(low == high, F(0), rounding);
        const auto entry = [&](F index) CHIARO_INLINE_LAMBDA { return truncate(min(max(index, F(0)), F(last))); };
        return extinction.between<F>(entry(mad(low, F(scale), F(offset)) - reach),
                                     entry(mad(high, F(scale), F(offset)) + reach));
    }
};

}  // namespace chiaro::kernel

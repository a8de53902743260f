// Regions of the volume with the largest extinction that a path can meet in them.
#pragma once
#include "kernel/gather.h"
#include "pathtrace/path.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// The low bits of a cell's majorant hold how far its region reaches, in cells; the majorant is rounded up to what is
/// left.
inline constexpr std::int32_t reach_mask = 127;

/// For each 4³ cell a cube of cells around it and the largest extinction in that cube (majorants.h), so that a path
/// crosses what is empty or even in few steps and meets what varies with majorants that are tight.
struct RegionsView {
    const float* cells;  ///< majorant per mm and reach; x fastest
    std::int32_t cells_x, cells_y;
    float nudge;  ///< voxels: what rounding can move a point by
    float nudge_mm;

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
        const F leave = min(exit(x, reach, path.origin.x, path.inverse.x, volume.last.x),
                            min(exit(y, reach, path.origin.y, path.inverse.y, volume.last.y),
                                exit(z, reach, path.origin.z, path.inverse.z, volume.last.z)));
        path.majorant = select(lost, float_of(code & I(~reach_mask)), path.majorant);
        path.leave = select(lost, min(max(leave, path.t + F(nudge_mm)), path.end), path.leave);
    }

private:
    /// Where the way leaves the slab of cells. The outermost cells go on beyond the volume's border.
    template <class F>
    static CHIARO_INLINE F exit(Int<F> cell, Int<F> reach, F origin, F inverse, float last) {
        using I = Int<F>;
        const F low = to_float((cell - reach) << I(cell_bits)), high = to_float((cell + reach + I(1)) << I(cell_bits));
        const F bound =
            select(inverse > F(0), select(high >= F(last), F(last + 1), high), select(low <= F(0), F(-1), low));
        return (bound - origin) * inverse;
    }
};

}  // namespace chiaro::kernel

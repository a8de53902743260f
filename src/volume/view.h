// The volume as a kernel sees it: value and gradient at any point.
#pragma once
#include "kernel/gather.h"
#include "kernel/vec.h"
#include "volume/bricks.h"

namespace chiaro::kernel {

/// A point between eight voxels: where the first lies in memory, and the share of the way to the next along each axis.
template <class F> struct Location {
    typename GatherIndex<F>::type index;
    Vec3<F> t;
};

/// The voxel whose interval [i, i + 1] holds a point, per axis.
template <class F> struct VoxelIndex {
    Int<F> x, y, z;
};

/// Voxels in bricks (volume/bricks.h). Points are in voxel coordinates, clamped to the box of the voxel centres.
template <class Voxel> struct VolumeView {
    const Voxel* voxels;
    std::int32_t bricks_x, bricks_y;
    Float3 last;                                  ///< n - 1 per axis
    std::int32_t last_x, last_y, last_z;          ///< last interval's voxel, max(n - 2, 0)

    template <class F> CHIARO_INLINE Vec3<F> clamp(Vec3<F> p) const {
        return {min(max(p.x, F(0)), F(last.x)), min(max(p.y, F(0)), F(last.y)), min(max(p.z, F(0)), F(last.z))};
    }

    /// Of a clamped point.
    template <class F> CHIARO_INLINE VoxelIndex<F> voxel(Vec3<F> p) const {
        return {min(truncate(p.x), Int<F>(last_x)), min(truncate(p.y), Int<F>(last_y)), min(truncate(p.z), Int<F>(last_z))};
    }

    template <class F> CHIARO_INLINE Location<F> locate(Vec3<F> p, VoxelIndex<F> i) const {
        using I = Int<F>;
        const I brick = ((i.z >> I(brick_bits)) * I(bricks_y) + (i.y >> I(brick_bits))) * I(bricks_x) + (i.x >> I(brick_bits));
        const I inside(brick_edge - 1), before(brick_before);
        const I local = ((i.z & inside) + before) * I(brick_slice) + ((i.y & inside) + before) * I(brick_row) + (i.x & inside) + before;
        return {typename GatherIndex<F>::type(brick * I(brick_voxels) + local),
                {p.x - to_float(i.x), p.y - to_float(i.y), p.z - to_float(i.z)}};
    }

    /// Trilinear; in stored units.
    template <class F> CHIARO_INLINE F value(const Location<F>& at) const {
        const F near = lerp(along_x(at, 0, 0), along_x(at, 1, 0), at.t.y);
        const F far = lerp(along_x(at, 0, 1), along_x(at, 1, 1), at.t.y);
        return lerp(near, far, at.t.z);
    }

    /// Central differences of one voxel, interpolated; stored units per voxel. At the border the missing neighbour is
    /// the border voxel itself. 32 voxels in 12 loads.
    template <class F> CHIARO_INLINE Vec3<F> gradient(const Location<F>& at) const {
        const Vec3<F> t = at.t;
        const Row<F> r00 = row(at, 0, 0), r10 = row(at, 1, 0), r01 = row(at, 0, 1), r11 = row(at, 1, 1);
        const F dx = lerp(lerp(r00.slope, r10.slope, t.y), lerp(r01.slope, r11.slope, t.y), t.z);
        const F dy = lerp(lerp(r10.value - along_x(at, -1, 0), along_x(at, 2, 0) - r00.value, t.y),
                          lerp(r11.value - along_x(at, -1, 1), along_x(at, 2, 1) - r01.value, t.y), t.z);
        const F dz = lerp(lerp(r01.value - along_x(at, 0, -1), r11.value - along_x(at, 1, -1), t.y),
                          lerp(along_x(at, 0, 2) - r00.value, along_x(at, 1, 2) - r10.value, t.y), t.z);
        return {F(0.5f) * dx, F(0.5f) * dy, F(0.5f) * dz};
    }

private:
    template <class F> struct Row {
        F value, slope;  ///< interpolated along x; slope over two voxels
    };

    template <class F> CHIARO_INLINE F along_x(const Location<F>& at, int y, int z) const {
        const Two<F> v = gather_two(voxels + (z * brick_slice + y * brick_row), at.index);
        return lerp(v.a, v.b, at.t.x);
    }
    template <class F> CHIARO_INLINE Row<F> row(const Location<F>& at, int y, int z) const {
        const Four<F> v = gather_four(voxels + (z * brick_slice + y * brick_row) - 1, at.index);
        return {lerp(v.b, v.c, at.t.x), lerp(v.c - v.a, v.d - v.b, at.t.x)};
    }
};

}  // namespace chiaro::kernel

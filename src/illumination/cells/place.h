// From a sample to the eight nodes of a grid around it.
#pragma once
#include "kernel/gather.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

/// Where a sample lies in a grid: its first node, and the way to the others.
template <class F>
struct GridLocation {
    Int<F> node;
    Vec3<F> t;
};

struct GridView {
    std::int32_t row, slice;              ///< distances along y and z; 0 along an axis of one node
    Float3 last;                          ///< count - 1 per axis
    std::int32_t last_x, last_y, last_z;  ///< last interval's node, max(count - 2, 0)
    Float3 nodes_per_voxel, shift;        ///< node = voxel × nodes_per_voxel + shift

    template <class F>
    CHIARO_INLINE GridLocation<F> locate(Vec3<F> p_voxel) const {
        const Vec3<F> p{along(p_voxel.x, nodes_per_voxel.x, shift.x, last.x),
                        along(p_voxel.y, nodes_per_voxel.y, shift.y, last.y),
                        along(p_voxel.z, nodes_per_voxel.z, shift.z, last.z)};
        using I = Int<F>;
        const I x = min(truncate(p.x), I(last_x)), y = min(truncate(p.y), I(last_y)), z = min(truncate(p.z), I(last_z));
        return {z * I(slice) + y * I(row) + x, {p.x - to_float(x), p.y - to_float(y), p.z - to_float(z)}};
    }
    /// How far a place lies beyond the outermost nodes: 0 up to them, 1 from one node edge off on.
    template <class F>
    CHIARO_INLINE F outside(Vec3<F> p_voxel) const {
        const F x = beyond(p_voxel.x, nodes_per_voxel.x, shift.x, last.x),
                y = beyond(p_voxel.y, nodes_per_voxel.y, shift.y, last.y),
                z = beyond(p_voxel.z, nodes_per_voxel.z, shift.z, last.z);
        return F(1) - (F(1) - x) * (F(1) - y) * (F(1) - z);
    }
    /// Of a node and those behind it along x, y, and both, one slice on too.
    CHIARO_INLINE Distances rows(std::int32_t stride = 1) const {
        return {0, stride * row, stride * slice, stride * (slice + row)};
    }

private:
    template <class F>
    static CHIARO_INLINE F along(F voxel, float scale, float offset, float highest) {
        return min(max(mad(voxel, F(scale), F(offset)), F(0)), F(highest));
    }
    template <class F>
    static CHIARO_INLINE F beyond(F voxel, float scale, float offset, float highest) {
        const F at = mad(voxel, F(scale), F(offset));
        return min(max(max(F(0) - at, at - F(highest)), F(0)), F(1));
    }
};

/// Trilinear; `near` and `far` along x, each at the four rows.
template <class F>
CHIARO_INLINE F trilinear(const Four<F>& near, const Four<F>& far, Vec3<F> t) {
    const F low = lerp(lerp(near.a, far.a, t.x), lerp(near.b, far.b, t.x), t.y);
    const F high = lerp(lerp(near.c, far.c, t.x), lerp(near.d, far.d, t.x), t.y);
    return lerp(low, high, t.z);
}

/// Shares in [0, 1] at the nodes of a grid, as 65535ths; x fastest. Between them trilinear, beyond the outermost as
/// there.
template <class F>
CHIARO_INLINE F share_at(const std::uint16_t* shares, const GridView& grid, Vec3<F> p) {
    const GridLocation<F> at = grid.locate(p);
    const auto v = gather_two(shares, typename GatherIndex<F>::type(at.node), grid.rows());
    return trilinear<F>({v.a.a, v.b.a, v.c.a, v.d.a}, {v.a.b, v.b.b, v.c.b, v.d.b}, at.t) * F(1.0f / 65535);
}

}  // namespace chiaro::kernel

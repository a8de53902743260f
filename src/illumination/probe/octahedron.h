// Directions on a square: the octahedron |x| + |y| + |z| = 1 unfolded (Praun and Hoppe 2003), +z in the middle.
#pragma once
#include "kernel/vec.h"

namespace chiaro::kernel {

/// Of the square, both in [0, 1].
template <class F>
struct OctahedronPlace {
    F u, v;
};

/// Where a direction of any length lies. A table with nodes on the square's border needs no more than bilinear look-ups
/// inside it: places on the border that are folded onto each other are one direction, and hold one value.
template <class F>
CHIARO_INLINE OctahedronPlace<F> octahedral(Vec3<F> d) {
    const F inverse = F(1) / max(abs(d.x) + abs(d.y) + abs(d.z), F(1e-30f));
    const F x = d.x * inverse, y = d.y * inverse;
    const F folded_x = select(x < F(0), abs(y) - F(1), F(1) - abs(y));
    const F folded_y = select(y < F(0), abs(x) - F(1), F(1) - abs(x));
    const Mask<F> below = d.z < F(0);
    const F half(0.5f);
    return {mad(select(below, folded_x, x), half, half), mad(select(below, folded_y, y), half, half)};
}

/// Between four nodes of a table of edge × edge: the first, and the weights of it, of the next along u, along v, both.
template <class F>
struct OctahedronCell {
    Int<F> entry;
    F weights[4];
};
template <class F>
CHIARO_INLINE OctahedronCell<F> octahedral_cell(Vec3<F> d, std::int32_t edge) {
    const OctahedronPlace<F> place = octahedral(d);
    const F u = place.u * F(float(edge - 1)), v = place.v * F(float(edge - 1));
    const Int<F> i = min(truncate(u), Int<F>(edge - 2)), j = min(truncate(v), Int<F>(edge - 2));
    const F s = u - to_float(i), t = v - to_float(j);
    return {j * Int<F>(edge) + i, {(F(1) - s) * (F(1) - t), s * (F(1) - t), (F(1) - s) * t, s * t}};
}

}  // namespace chiaro::kernel

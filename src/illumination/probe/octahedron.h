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

}  // namespace chiaro::kernel

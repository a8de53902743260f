// Rays in voxel coordinates, distances along them in millimetres, and boxes that they meet.
#pragma once
#include "kernel/vec.h"

namespace chiaro::kernel {

template <class F>
struct Ray {
    Vec3<F> origin, direction;  ///< voxels, voxels per mm
};

/// Where a ray is inside the box: [near, far] in mm; empty when far <= near.
template <class F>
struct Interval {
    F near, far;
};

/// Keeps a component away from 0, so that slabs parallel to the ray lie very far off instead of at 0 / 0.
template <class F>
CHIARO_INLINE F away_from_zero(F d) {
    return select(abs(d) < F(1e-12f), select(d < F(0), F(-1e-12f), F(1e-12f)), d);
}

template <class F>
CHIARO_INLINE void clip_slab(F origin, F direction, float low, float high, Interval<F>& i) {
    const F inverse = F(1) / away_from_zero(direction);
    const F a = (F(low) - origin) * inverse, b = (F(high) - origin) * inverse;
    i.near = max(i.near, min(a, b));
    i.far = min(i.far, max(a, b));
}

/// Ray against box by slabs (Kay and Kajiya 1986); a ray that starts inside begins at 0.
template <class F>
CHIARO_INLINE Interval<F> intersect(const Ray<F>& ray, Float3 low, Float3 high) {
    Interval<F> i{F(0), F(3e38f)};
    clip_slab(ray.origin.x, ray.direction.x, low.x, high.x, i);
    clip_slab(ray.origin.y, ray.direction.y, low.y, high.y, i);
    clip_slab(ray.origin.z, ray.direction.z, low.z, high.z, i);
    return i;
}

}  // namespace chiaro::kernel

// Rays of a camera, in voxel coordinates; distances along a ray are millimetres.
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

struct CameraView {
    Float3 eye;                 ///< voxels
    Float3 forward, right, up;  ///< voxels per mm along the orthonormal world axes
    float half_width, half_height;
    float width, height;  ///< pixels
    bool orthographic;

    template <class F>
    CHIARO_INLINE Ray<F> ray(F column, F row) const {
        const F px = ((column + F(0.5f)) * F(2 / width) - F(1)) * F(half_width);
        const F py = (F(1) - (row + F(0.5f)) * F(2 / height)) * F(half_height);
        const Vec3<F> offset = mad(px, Vec3<F>(right), py * Vec3<F>(up));
        if (orthographic) return {Vec3<F>(eye) + offset, Vec3<F>(forward)};
        const F inverse_length = F(1) / sqrt(mad(px, px, mad(py, py, F(1))));  // of the world vector
        return {Vec3<F>(eye), inverse_length * (Vec3<F>(forward) + offset)};
    }
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

// Rays of a camera, in voxel coordinates; distances along a ray are millimetres.
#pragma once
#include "kernel/math.h"
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
    float centre_x, centre_y;  ///< of the view
    float width, height;       ///< pixels
    bool orthographic;
    float lens_mm = 0, focus_mm = 1;  ///< radius of the lens; depth that is in focus

    template <class F>
    CHIARO_INLINE Ray<F> ray(F column, F row) const {
        const F px = across(column), py = upwards(row);
        const Vec3<F> offset = mad(px, Vec3<F>(right), py * Vec3<F>(up));
        if (orthographic) return {Vec3<F>(eye) + offset, Vec3<F>(forward)};
        const F inverse_length = F(1) / sqrt(mad(px, px, mad(py, py, F(1))));  // of the world vector
        return {Vec3<F>(eye), inverse_length * (Vec3<F>(forward) + offset)};
    }

    /// Where a pixel's middle lies in the view, along right and up.
    template <class F>
    CHIARO_INLINE F across(F column) const {
        return ((column + F(0.5f)) * F(2 / width) - F(1)) * F(half_width) + F(centre_x);
    }
    template <class F>
    CHIARO_INLINE F upwards(F row) const {
        return (F(1) - (row + F(0.5f)) * F(2 / height)) * F(half_height) + F(centre_y);
    }
};

/// From a point of the camera's lens, which two numbers in [0, 1) choose evenly, through the place in focus that the
/// pixel shows.
template <class F>
CHIARO_INLINE Ray<F> ray_through_lens(const CameraView& camera, F column, F row, F radius, F turns) {
    const F px = camera.across(column), py = camera.upwards(row);
    const SinCos<F> around = sin_cos(turns);
    const F r = F(camera.lens_mm) * sqrt(radius), x = r * around.cos, y = r * around.sin;
    // Perspective: the pixel's place in focus lies aside of the axis, the lens about the eye; orthographic: the other
    // way round.
    const F spread = camera.orthographic ? F(0) : F(camera.focus_mm), shift = camera.orthographic ? F(1) : F(0);
    const Vec3<F> right(camera.right), up(camera.up);
    const Vec3<F> origin = Vec3<F>(camera.eye) + mad(mad(shift, px, x), right, mad(shift, py, y) * up);
    const F a = spread * px - x, b = spread * py - y, focus(camera.focus_mm);
    const F inverse_length = F(1) / sqrt(mad(a, a, mad(b, b, focus * focus)));  // of the world vector
    return {origin, inverse_length * (focus * Vec3<F>(camera.forward) + mad(a, right, b * up))};
}

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

// Rays of a camera, in voxel coordinates; distances along a ray are millimetres.
#pragma once
#include "kernel/math.h"
#include "kernel/ray.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

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

}  // namespace chiaro::kernel

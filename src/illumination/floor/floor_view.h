// The floor as rays meet it: a plane, seen and lit from above, that fades out around the subject.
#pragma once
#include "kernel/math.h"
#include "kernel/ray.h"

namespace chiaro::kernel {

struct FloorView {
    bool on = false;
    Float3 rise{};                ///< of the height over it: mm per voxel
    float rise_0 = 0;             ///< mm, at voxel (0, 0, 0)
    Float3 along_u{}, along_v{};  ///< across it, in radii of the subject per voxel
    float u_0 = 0, v_0 = 0;       ///< at voxel (0, 0, 0); 0 under the subject
    Float3 up{};                  ///< unit, world

    /// Radii of the subject from below its middle: up to the first the floor is whole, beyond the second there is none.
    static constexpr float whole = 1.1f, end = 2.4f;

    template <class F>
    CHIARO_INLINE F height(Vec3<F> p) const {
        return dot(Vec3<F>(rise), p) + F(rise_0);
    }
    /// mm a mm; < 0 towards the floor.
    template <class F>
    CHIARO_INLINE F climb(Vec3<F> direction) const {
        return dot(Vec3<F>(rise), direction);
    }
    /// How far a ray has to go to it, from above; very far where it never does.
    template <class F>
    CHIARO_INLINE F distance(const Ray<F>& ray) const {
        const F above = height(ray.origin), rate = climb(ray.direction);
        const Mask<F> meets = (above > F(0)) & (rate < F(-1e-6f));
        return select(meets, above / max(F(0) - rate, F(1e-6f)), F(3e38f));
    }
    template <class F>
    CHIARO_INLINE F u(Vec3<F> p) const {
        return dot(Vec3<F>(along_u), p) + F(u_0);
    }
    template <class F>
    CHIARO_INLINE F v(Vec3<F> p) const {
        return dot(Vec3<F>(along_v), p) + F(v_0);
    }
    /// How much of it is there, to the eye. For light it has no end.
    template <class F>
    CHIARO_INLINE F share(F u, F v) const {
        const F r = sqrt(mad(u, u, v * v));
        const F t = min(max((F(end) - r) * F(1 / (end - whole)), F(0)), F(1));
        return t * t * (F(3) - F(2) * t);
    }
};

}  // namespace chiaro::kernel

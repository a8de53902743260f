// A sun's light on a surface: its own share of each node, by straight rays, for sixteen harmonics blur its shadow.
#pragma once
#include "kernel/math.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

struct SunLight {
    const std::uint8_t* nodes = nullptr;  ///< transmittance towards it × 255; nullptr: there is no sun
    Float3 direction{0, 0, 0};            ///< unit, towards it, in the axes of the grid
    Float3 light{0, 0, 0};                ///< E of a surface that faces it

    /// Which way its share is read off a surface: along the sun's own ray, so that a shadow lies where it falls, until
    /// the place is as high as it would be along the normal. At grazing angles the ray is followed twice as far as
    /// that height, and the rest is along the normal: with 1, 2, 3 and 6 as shown under the sky `sample:tubes` is 7.3,
    /// 7.2, 7.2 and 7.2 % off the reference (7.9 along the normal), a bonsai 5.9, 5.9, 6.0 and 6.2 (6.9).
    template <class F>
    CHIARO_INLINE Vec3<F> way_off(Vec3<F> normal) const {
        constexpr float max_edges = 2;
        const Vec3<F> ray(direction);
        const F cosine = dot(normal, ray), edges = min(F(1) / max(cosine, F(1e-3f)), F(max_edges)),
                left = max(F(1) - edges * cosine, F(0));
        return {mad(edges, ray.x, left * normal.x), mad(edges, ray.y, left * normal.y),
                mad(edges, ray.z, left * normal.z)};
    }
    /// Share of its light between eight nodes.
    CHIARO_INLINE float arriving(const std::int64_t (&of)[8], const float (&weights)[8]) const {
        float sum = 0;
        for (int i = 0; i < 8; ++i) sum = mad(weights[i], float(nodes[of[i]]), sum);
        return sum / 255;
    }
    /// E is added to the three channels: what arrives × `shown`, and `clear` of all of it; to `open` all of it.
    CHIARO_INLINE void add_to(float* e, float* open, float arriving, const float (&normal)[3], float shown,
                              float clear) const {
        const float cosine = normal[0] * direction.x + normal[1] * direction.y + normal[2] * direction.z;
        if (cosine <= 0) return;
        const float of_light = cosine * mad(arriving, shown, clear);
        e[0] = mad(of_light, light.x, e[0]), e[1] = mad(of_light, light.y, e[1]), e[2] = mad(of_light, light.z, e[2]);
        open[0] = mad(cosine, light.x, open[0]), open[1] = mad(cosine, light.y, open[1]);
        open[2] = mad(cosine, light.z, open[2]);
    }
};

}  // namespace chiaro::kernel

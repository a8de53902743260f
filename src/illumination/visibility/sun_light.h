// Light with a shadow of its own on surfaces, found by rays of its parts, for sixteen harmonics blur it: a sun's, or a
// lamp's, in parts.
#pragma once
#include "kernel/math.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

struct SunLight {
    static constexpr std::int32_t max_parts = 4;
    using Shares = float[max_parts];

    const std::uint8_t* nodes = nullptr;  ///< [node][part]: transmittance towards it × 255; nullptr: there is none
    std::int32_t parts = 0;               ///< one, or all
    Float3 ray{0, 0, 0};                  ///< unit, towards the middle of its parts, in the axes of the grid
    Shares direction[3]{};                ///< [axis], unit, towards each part
    Shares light[3]{};                    ///< [channel]: E of a surface that faces it

    /// Which way shares are read off a surface: along the sun's own ray, so that a shadow lies where it falls, until
    /// the place is as high as it would be along the normal. At grazing angles the ray is followed twice as far as
    /// that height, and the rest is along the normal: with 1, 2, 3 and 6 as shown by transport under the sky
    /// `sample:tubes` is 7.3, 7.2, 7.2 and 7.2 % off the reference (7.9 along the normal), a bonsai 5.9, 5.9, 6.0 and
    /// 6.2 (6.9).
    template <class F>
    CHIARO_INLINE Vec3<F> way_off(Vec3<F> normal) const {
        constexpr float max_edges = 2;
        const Vec3<F> way(ray);
        const F cosine = dot(normal, way), edges = min(F(1) / max(cosine, F(1e-3f)), F(max_edges)),
                left = max(F(1) - edges * cosine, F(0));
        return {mad(edges, way.x, left * normal.x), mad(edges, way.y, left * normal.y),
                mad(edges, way.z, left * normal.z)};
    }
    /// Shares of its light between eight nodes.
    CHIARO_INLINE void arriving(const std::int64_t (&of)[8], const float (&weights)[8], Shares& shares) const {
        if (parts == 1)
            add_up<1>(of, weights, shares);
        else
            add_up<max_parts>(of, weights, shares);
    }
    /// E is added to the three channels: what arrives × `shown`, and `clear` of all of it; to `open` all of it.
    CHIARO_INLINE void add_to(float* e, float* open, const Shares& arriving, const float (&normal)[3], float shown,
                              float clear) const {
        for (std::int32_t part = 0; part < parts; ++part) {
            const float cosine =
                normal[0] * direction[0][part] + normal[1] * direction[1][part] + normal[2] * direction[2][part];
            if (cosine <= 0) continue;
            const float of_light = cosine * mad(arriving[part], shown, clear);
            for (std::int32_t c = 0; c < 3; ++c) {
                e[c] = mad(of_light, light[c][part], e[c]);
                open[c] = mad(cosine, light[c][part], open[c]);
            }
        }
    }

private:
    template <std::int32_t count>
    CHIARO_INLINE void add_up(const std::int64_t (&of)[8], const float (&weights)[8], Shares& shares) const {
        float sums[count]{};
        for (int i = 0; i < 8; ++i)
            for (std::int32_t part = 0; part < count; ++part)
                sums[part] = mad(weights[i], float(nodes[of[i] * count + part]), sums[part]);
        for (std::int32_t part = 0; part < count; ++part) shares[part] = sums[part] / 255;
    }
};

}  // namespace chiaro::kernel

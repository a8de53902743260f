// Light with a shadow of its own on surfaces, found by rays of its parts, for sixteen harmonics blur it: a sun's, or a
// lamp's, in parts.
#pragma once
#include "kernel/row.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

struct SunLight {
    static constexpr std::int32_t max_parts = 4;
    const std::uint8_t* nodes = nullptr;  ///< [node][part]: transmittance towards it × 255; nullptr: there is none
    std::int32_t parts = 0;               ///< one, or all
    Float3 ray{0, 0, 0};                  ///< unit, towards the middle of its parts, in the axes of the grid
    float direction[3][max_parts]{};      ///< [axis], unit, towards each part
    float light[max_parts][4]{};          ///< [part][channel]: E of a surface that faces it

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
    /// Shares of its parts' light between eight nodes; of one part all the same.
    template <class Four>
    CHIARO_INLINE Four arriving(const std::int64_t (&of)[8], const float (&weights)[8]) const {
        if (parts == 1) {
            float share = 0;
            for (int i = 0; i < 8; ++i) share = mad(weights[i], float(nodes[of[i]]), share);
            return Four(share / 255);
        }
        Four shares(0.0f);
        for (int i = 0; i < 8; ++i)
            shares = shares + Four(weights[i]) * loaded<Four>(nodes + of[i] * std::int64_t(max_parts));
        return shares * Four(1.0f / 255);
    }
    /// E is added to the channels: what arrives × `shown`, and `clear` of all of it; to `open` all of it.
    template <class Four>
    CHIARO_INLINE void add_to(Four& e, Four& open, const Four& arriving, const float (&normal)[3], float shown,
                              float clear) const {
        const Four along =
            (Four(normal[0]) * loaded<Four>(direction[0]) + Four(normal[1]) * loaded<Four>(direction[1])) +
            Four(normal[2]) * loaded<Four>(direction[2]);
        const Four facing = max(along, Four(0.0f));
        float all[max_parts], lit[max_parts];
        store(facing, all);
        store(facing * (arriving * Four(shown) + Four(clear)), lit);
        for (std::int32_t part = 0; part < parts; ++part) {
            const Four of_part = loaded<Four>(light[part]);
            e = e + Four(lit[part]) * of_part;
            open = open + Four(all[part]) * of_part;
        }
    }
};

}  // namespace chiaro::kernel

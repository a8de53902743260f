// Nodes one by one: from the field to what is kept of it, and from that to the light of a probe.
#pragma once
#include "illumination/cells/kernel.h"
#include "illumination/visibility/stored.h"
#include "illumination/visibility/surface_light.h"
#include "kernel/math.h"

namespace chiaro::kernel {

/// Where the surface at a node faces, and how much of the node is one.
struct NodeSurface {
    std::int8_t x, y, z;  ///< n, unit, × 127
    std::uint8_t share;   ///< q × 255
};

/// A row of nodes.
struct NodeRow {
    std::int32_t y, z;
};

/// Opacity of one node edge.
struct OpacityKernel {
    const float* density;
    float* opacity;

    CHIARO_INLINE void operator()(std::int64_t first, std::int32_t count) const {
        for (std::int32_t i = 0; i < count; ++i)
            opacity[first + i] = 1 - exp2_below_0(density[first + i] * -1.442695041f);
    }
};

struct KeepKernel {
    const float* field;    ///< [node][coefficients]
    const float* opacity;  ///< of a node edge; nullptr: the field is kept where it is
    const float* shares;   ///< q of the nodes
    void* harmonics;
    NodeSurface* surfaces;
    Stored stored;
    std::int32_t coefficients;
    std::int32_t count[3];
    float steps[16];  ///< of the coefficients in 8 bits

    CHIARO_INLINE void operator()(NodeRow row) const {
        for (std::int32_t x = 0; x < count[0]; ++x) keep_node(x, row.y, row.z);
    }

    CHIARO_INLINE void keep_node(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const std::int64_t node = index(x, y, z);
        const float* from = field + node * coefficients;
        float displaced[16];
        if (opacity) {
            const Outwards out = outwards(x, y, z);
            const float size = sqrt(dot(out.n, out.n)), inverse = size > 0 ? 127 / size : 0;
            const float near = size > 0 ? surface_near(x, y, z) : 0;
            const std::uint8_t share = std::uint8_t(near * outward_share(out.n, 1.0f) * 255 + 0.5f);
            surfaces[node] = {signed_byte(inverse * out.n.x), signed_byte(inverse * out.n.y),
                              signed_byte(inverse * out.n.z), share};
            if (share) {
                normal_offset((near * out.edges / max(size, 1.0f)) * out.n, x, y, z, displaced);
                from = displaced;
            }
        }
        keep(from, node);
    }

private:
    CHIARO_INLINE std::int64_t index(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return (std::int64_t(z) * count[1] + y) * count[0] + x;
    }
    CHIARO_INLINE float alpha(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const bool inside = x >= 0 && y >= 0 && z >= 0 && x < count[0] && y < count[1] && z < count[2];
        return inside ? opacity[index(x, y, z)] : 0;
    }
    struct Outwards {
        Vec3<float> n;
        float edges;  ///< to where the surface's light is seen
    };
    /// n = -(α(i + 1) - α(i - 1)) per axis. Within matter also over twice the distance: samples on the surface lie
    /// between its nodes and those, which would darken them in stripes.
    CHIARO_INLINE Outwards outwards(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const Vec3<float> n = normal(x, y, z, 1);
        if (alpha(x, y, z) < 0.5f) return {n, 1};
        const Vec3<float> wide = normal(x, y, z, 2);
        return dot(wide, wide) > dot(n, n) ? Outwards{wide, 2} : Outwards{n, 1};
    }
    CHIARO_INLINE Vec3<float> normal(std::int32_t x, std::int32_t y, std::int32_t z, std::int32_t d) const {
        return {alpha(x - d, y, z) - alpha(x + d, y, z), alpha(x, y - d, z) - alpha(x, y + d, z),
                alpha(x, y, z - d) - alpha(x, y, z + d)};
    }
    /// The largest there and around: what is read of a surface lies on both of its sides.
    CHIARO_INLINE float surface_near(std::int32_t x, std::int32_t y, std::int32_t z) const {
        float most = 0;
        for (std::int32_t k = max(z - 1, 0); k <= min(z + 1, count[2] - 1); ++k)
            for (std::int32_t j = max(y - 1, 0); j <= min(y + 1, count[1] - 1); ++j)
                for (std::int32_t i = max(x - 1, 0); i <= min(x + 1, count[0] - 1); ++i)
                    most = max(most, shares[index(i, j, k)]);
        return most;
    }
    static CHIARO_INLINE std::int8_t signed_byte(float v) { return std::int8_t(v < 0 ? v - 0.5f : v + 0.5f); }

    /// The field at the node + way, trilinear; beyond the grid the nearest node's.
    CHIARO_INLINE void normal_offset(Vec3<float> way, std::int32_t x, std::int32_t y, std::int32_t z, float* to) const {
        const float p[3] = {float(x) + way.x, float(y) + way.y, float(z) + way.z};
        std::int32_t low[3], high[3];
        float share[3];
        for (int axis = 0; axis < 3; ++axis) {
            const float whole = floor(p[axis]);
            share[axis] = p[axis] - whole;
            low[axis] = min(max(std::int32_t(whole), 0), count[axis] - 1);
            high[axis] = min(max(std::int32_t(whole) + 1, 0), count[axis] - 1);
        }
        for (int c = 0; c < coefficients; ++c) to[c] = 0;
        for (int corner = 0; corner < 8; ++corner) {
            std::int32_t at[3];
            float weight = 1;
            for (int axis = 0; axis < 3; ++axis) {
                const bool further = corner >> axis & 1;
                at[axis] = further ? high[axis] : low[axis];
                weight *= further ? share[axis] : 1 - share[axis];
            }
            if (!(weight > 0)) continue;
            const float* from = field + index(at[0], at[1], at[2]) * coefficients;
            for (int c = 0; c < coefficients; ++c) to[c] = mad(weight, from[c], to[c]);
        }
    }

    CHIARO_INLINE void keep(const float* from, std::int64_t node) const {
        const std::int64_t first = node * coefficients;
        if (stored == Stored::u8) {
            std::int8_t* to = static_cast<std::int8_t*>(harmonics) + first;
            for (int c = 1; c < coefficients; ++c) to[c] = signed_byte(min(max(from[c] / steps[c], -127.0f), 127.0f));
            to[0] = std::int8_t(std::uint8_t(min(max(from[0] / steps[0], 0.0f), 255.0f) + 0.5f));
        } else if (stored == Stored::f16) {
            std::uint16_t* to = static_cast<std::uint16_t*>(harmonics) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = to_half(from[c]);
        } else {
            float* to = static_cast<float*>(harmonics) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = from[c];
        }
    }
};

/// E = (1 - q) / (4π) Σ V_lm L_lm + q / π Σ V_lm [L max(0, n·ω)]_lm, over the scale.
struct LightKernel {
    StoredHarmonics harmonics;
    const NodeSurface* surfaces;  ///< nullptr: q = 0 everywhere
    HarmonicsLight particles;     ///< L_lm / (4π)
    SurfaceLight surface;
    float per_unit[4];  ///< 1 / scale
    Strength strength;
    Light16* light;  ///< [node][4]

    CHIARO_INLINE void operator()(std::int64_t first, std::int32_t count) const {
        for (std::int64_t node = first; node < first + count; ++node) {
            float visibility[16], sums[4] = {0, 0, 0, 0};
            harmonics.load(node, visibility);
            strength.apply(visibility);
            particles.add_to(sums, visibility);
            if (surfaces && surfaces[node].share) {
                const NodeSurface s = surfaces[node];
                const float q = float(s.share) * (1.0f / 255);
                for (float& sum : sums) sum *= 1 - q;
                surface.add_to(sums, visibility, {float(s.x), float(s.y), float(s.z)}, q);
            }
            for (int k = 0; k < 4; ++k) light[4 * node + k] = kernel::to_light(sums[k] * per_unit[k]);
        }
    }
};

}  // namespace chiaro::kernel

// Nodes one by one: from the field to what is kept of it, and from that to the light of a probe.
#pragma once
#include "illumination/cells/node_light.h"
#include "illumination/visibility/stored.h"
#include "illumination/visibility/surface_light.h"
#include "kernel/math.h"

namespace chiaro::kernel {

/// Coefficients of a node as they are kept.
struct KeepKernel {
    const float* field;  ///< [node][coefficients]
    void* harmonics;
    Stored stored;
    std::int32_t coefficients;
    float steps[16];  ///< of the coefficients in 8 bits

    CHIARO_INLINE void operator()(std::int64_t first_node, std::int32_t count) const {
        for (std::int64_t node = first_node; node < first_node + count; ++node) keep(node * coefficients);
    }

private:
    static CHIARO_INLINE std::int8_t signed_byte(float v) { return std::int8_t(v < 0 ? v - 0.5f : v + 0.5f); }

    CHIARO_INLINE void keep(std::int64_t first) const {
        const float* from = field + first;
        if (stored == Stored::u8) {
            std::int8_t* to = static_cast<std::int8_t*>(harmonics) + first;
            for (int c = 1; c < coefficients; ++c) to[c] = signed_byte(min(max(from[c] / steps[c], -127.0f), 127.0f));
            to[0] =
                std::int8_t(std::int32_t(min(max(from[0] / steps[0], 0.0f), 255.0f) + 0.5f) - StoredHarmonics::middle);
        } else if (stored == Stored::f16) {
            std::uint16_t* to = static_cast<std::uint16_t*>(harmonics) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = to_half(from[c]);
        } else {
            float* to = static_cast<float*>(harmonics) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = from[c];
        }
    }
};

/// On particles: E = 1 / (4π) Σ V_lm L_lm, over the scale.
struct LightKernel {
    StoredHarmonics harmonics;
    HarmonicsLight particles;  ///< L_lm / (4π)
    float per_unit[4];         ///< 1 / scale
    Strength strength;
    Light16* light;  ///< [node][4]

    CHIARO_INLINE void operator()(std::int64_t first, std::int32_t count) const {
        for (std::int64_t node = first; node < first + count; ++node) {
            float visibility[16], sums[4] = {0, 0, 0, 0};
            harmonics.load(node, visibility);
            strength.apply(visibility);
            particles.add_to(sums, visibility);
            for (int k = 0; k < 4; ++k) light[4 * node + k] = kernel::to_light(sums[k] * per_unit[k]);
        }
    }
};

}  // namespace chiaro::kernel

// Nodes one by one: from the field to what is kept of it, and from that to the light of a probe.
#pragma once
#include "illumination/cells/node_light.h"
#include "illumination/visibility/stored.h"
#include "illumination/visibility/surface_light.h"
#include "kernel/math.h"
#include "kernel/prefetch.h"

namespace chiaro::kernel {

/// Sums of coefficients that are to be kept in 8 bits: whole steps in 16 bits, 128 to one of the first coefficient's
/// and 256 to one of the others'. Each part is rounded once: sums of six are within an 80th of a step of 8 bits.
struct AddSteps {
    static constexpr std::int32_t width = 16;
    float per_unit[width];
    std::int32_t coefficients;

    static CHIARO_INLINE std::int32_t per_byte(std::int32_t coefficient) { return coefficient == 0 ? 128 : 256; }

    template <class F>
    static CHIARO_INLINE F load(const std::uint16_t* steps) {
        const F bits = to_float(load_shorts<F>(steps));
        return bits - select(bits < F(32768), F(0), F(65536));
    }
    /// Adds a part, which is told in steps.
    template <class F>
    static CHIARO_INLINE void add(F part, std::uint16_t* steps) {
        const F rounded = to_float(truncate(part + select(part < F(0), F(-0.5f), F(0.5f))));
        store_whole(truncate(min(max(load<F>(steps) + rounded, F(-32768)), F(32767))), steps);
    }

    /// Adds the parts of `count` nodes that lie next to each other, and leaves 0 there; the sums of nodes are `stride`
    /// apart.
    template <class F>
    CHIARO_INLINE void operator()(float* parts, std::int32_t count, std::uint16_t* to, std::int64_t stride) const {
        constexpr std::int32_t ahead = 8;
        for (std::int32_t n = 0; n < count; ++n, parts += coefficients, to += stride) {
            if (n + ahead < count) prefetch(to + ahead * stride);
            if (coefficients == width)
                add_node<F, width>(parts, to);
            else
                add_node<float, 4>(parts, to);
        }
    }

private:
    template <class F, std::int32_t numbers>
    CHIARO_INLINE void add_node(float* parts, std::uint16_t* to) const {
        for (std::int32_t c = 0; c < numbers; c += LaneTraits<F>::count) {
            add(load_row<F>(parts + c) * load_row<F>(per_unit + c), to + c);
            store_row(parts + c, F(0));
        }
    }
};

/// Coefficients of nodes as they are kept.
struct KeepKernel {
    static constexpr std::int32_t width = 16;
    const float* field;         ///< [node][coefficients]
    const std::uint16_t* sums;  ///< of AddSteps, in the place of the field; or null
    void* harmonics;
    Stored stored;
    std::int32_t coefficients;
    /// In 8 bits: of sixteen numbers one after the other. The first of a node has no sign, and is kept less its middle.
    float steps[width], least[width], most[width], middle[width];
    float per_sum[width];  ///< steps

    template <class F = float>
    CHIARO_INLINE void operator()(std::int64_t first_node, std::int32_t count) const {
        const std::int64_t first = first_node * coefficients, end = first + std::int64_t(count) * coefficients;
        std::int64_t i = first;
        if (stored == Stored::u8) {
            for (; i + width <= end; i += width) bytes<F, width>(i);
            for (; i < end; i += coefficients) bytes<float, 4>(i);  // nodes of four
        } else if (stored == Stored::f16) {
            for (; i < end; ++i) static_cast<std::uint16_t*>(harmonics)[i] = to_half(field[i]);
        } else {
            for (; i < end; ++i) static_cast<float*>(harmonics)[i] = field[i];
        }
    }

private:
    /// To the nearest step, from a node's first number on.
    template <class F, std::int32_t count>
    CHIARO_INLINE void bytes(std::int64_t i) const {
        float rounded[count];
        for (std::int32_t lane = 0; lane < count; lane += LaneTraits<F>::count) {
            const F ratio = sums ? AddSteps::load<F>(sums + i + lane) * load_row<F>(per_sum + lane)
                                 : load_row<F>(field + i + lane) / load_row<F>(steps + lane);
            const F v = min(max(ratio, load_row<F>(least + lane)), load_row<F>(most + lane));
            const F away = v + select(v < F(0), F(-0.5f), F(0.5f));
            store_row(rounded + lane, to_float(truncate(away)) - load_row<F>(middle + lane));
        }
        std::int8_t* to = static_cast<std::int8_t*>(harmonics) + i;
        for (std::int32_t lane = 0; lane < count; ++lane) to[lane] = std::int8_t(std::int32_t(rounded[lane]));
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

// Coefficients as they are kept: 8 bits, halves or floats (docs/theory/visibility.md).
#pragma once
#include "kernel/half.h"
#include "kernel/row.h"

namespace chiaro::kernel {

enum class Stored : std::int32_t { u8, f16, f32 };

/// V' = 1 - strength (1 - V)
struct Strength {
    float shown, clear;  ///< V is multiplied by the first; the second is added to its mean

    CHIARO_INLINE void apply(float* visibility) const {
        for (int c = 0; c < 16; ++c) visibility[c] *= shown;
        visibility[0] += clear;
    }
};

/// The coefficients of a node, in units of their steps where they are kept in 8 bits. The first has no sign: it is kept
/// less `middle` then.
struct StoredHarmonics {
    static constexpr std::int32_t middle = 128;
    const void* nodes;
    Stored stored;
    std::int32_t coefficients;

    /// All sixteen; those that there are not: 0.
    CHIARO_INLINE void load(std::int64_t node, float* to) const {
        const std::int64_t first = node * coefficients;
        for (int c = coefficients; c < 16; ++c) to[c] = 0;
        if (stored == Stored::u8) {
            const std::int8_t* from = static_cast<const std::int8_t*>(nodes) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = float(from[c]);
            to[0] += float(middle);
        } else if (stored == Stored::f16) {
            const std::uint16_t* from = static_cast<const std::uint16_t*>(nodes) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = from_half(from[c]);
        } else {
            const float* from = static_cast<const float*>(nodes) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = from[c];
        }
    }

    /// Σ weights × those of eight nodes; the weights add up to 1.
    template <class Sixteen>
    CHIARO_INLINE Sixteen mix(const std::int64_t (&of)[8], const float (&weights)[8]) const {
        Sixteen sum(0.0f);
        if (stored == Stored::u8 && coefficients == 16) {
            const std::int8_t* bytes = static_cast<const std::int8_t*>(nodes);
            for (std::int32_t i = 0; i < 8; ++i) sum = sum + Sixteen(weights[i]) * loaded<Sixteen>(bytes + 16 * of[i]);
            const float offset[16] = {float(middle)};
            return sum + loaded<Sixteen>(offset);
        }
        for (std::int32_t i = 0; i < 8; ++i) {
            float of_node[16];
            load(of[i], of_node);
            sum = sum + Sixteen(weights[i]) * loaded<Sixteen>(of_node);
        }
        return sum;
    }
};

}  // namespace chiaro::kernel

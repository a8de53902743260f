// Coefficients as they are kept: 8 bits, halves or floats (docs/theory/visibility.md).
#pragma once
#include "kernel/half.h"

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

/// The coefficients of a node, in units of their steps where they are kept in 8 bits.
struct StoredHarmonics {
    const void* nodes;
    Stored stored;
    std::int32_t coefficients;

    /// All sixteen; those that there are not: 0.
    CHIARO_INLINE void load(std::int64_t node, float* to) const {
        const std::int64_t first = node * coefficients;
        for (int c = coefficients; c < 16; ++c) to[c] = 0;
        if (stored == Stored::u8) {
            const std::uint8_t* from = static_cast<const std::uint8_t*>(nodes) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = float(std::int8_t(from[c]));
            to[0] = float(from[0]);  // the mean has no sign
        } else if (stored == Stored::f16) {
            const std::uint16_t* from = static_cast<const std::uint16_t*>(nodes) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = from_half(from[c]);
        } else {
            const float* from = static_cast<const float*>(nodes) + first;
            for (int c = 0; c < coefficients; ++c) to[c] = from[c];
        }
    }
};

}  // namespace chiaro::kernel

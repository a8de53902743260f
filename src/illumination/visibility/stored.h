// Coefficients as they are kept: 8 bits, halves or floats (illumination.md 2.6).
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

enum class Stored : std::int32_t { u8, f16, f32 };

/// Finite halves; those too small for one are kept as what they are.
CHIARO_INLINE float from_half(std::uint16_t half) {
    const float size = float_of(std::int32_t(half & 0x7fff) << 13) * 5.192296858534828e33f;  // 2^112
    return half & 0x8000 ? -size : size;
}
/// The nearest half, ties to even; |value| < 65520.
CHIARO_INLINE std::uint16_t to_half(float value) {
    const std::int32_t sign = (bits_of(value) >> 16) & 0x8000;
    const float size = abs(value);
    // Below 2^-14 halves are as far apart as 2^-24: adding 2^-1 rounds to that.
    if (size < 6.103515625e-05f) return std::uint16_t(sign | (bits_of(size + 0.5f) - bits_of(0.5f)));
    const std::int32_t bits = bits_of(size), odd = (bits >> 13) & 1;
    return std::uint16_t(sign | ((bits + 0xfff + odd - (112 << 23)) >> 13));
}

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

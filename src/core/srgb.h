// The sRGB transfer curve (IEC 61966-2-1), on [0, 1], and what its primaries weigh.
#pragma once
#include <array>
#include <cmath>

#include "kernel/lanes.h"

namespace chiaro {

inline double linear_from_srgb(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }
CHIARO_INLINE double srgb_from_linear(double c) {
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

/// Red, green and blue weigh so much in luminance (Rec. 709).
inline constexpr std::array<double, 3> luminance_weights{0.2126, 0.7152, 0.0722};

/// Of linear light, or, as luma, of display values.
inline double luminance(const float* rgb) {
    return luminance_weights[0] * rgb[0] + luminance_weights[1] * rgb[1] + luminance_weights[2] * rgb[2];
}

}  // namespace chiaro

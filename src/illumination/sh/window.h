// Factors per band that trade ringing for sharpness (Sloan 2008, "Stupid Spherical Harmonics Tricks").
#pragma once
#include <chiaro/lighting.h>

#include <array>
#include <cmath>
#include <numbers>

#include "illumination/sh/basis.h"

namespace chiaro {

/// With w = `bands`, the first band that is left out, and x = l / w: Hann (1 + cos πx) / 2, Lanczos sin(πx) / (πx),
/// else 1; 0 from w on. Four bands by Hann: 1, .854, .5, .146; by Lanczos: 1, .900, .637, .300.
inline std::array<double, max_bands> window_factors(ShWindow window, int bands) {
    std::array<double, max_bands> factors{};
    for (int l = 0; l < bands; ++l) {
        const double x = std::numbers::pi * l / bands;
        if (window == ShWindow::hann)
            factors[l] = (1 + std::cos(x)) / 2;
        else
            factors[l] = window == ShWindow::lanczos && l > 0 ? std::sin(x) / x : 1;
    }
    return factors;
}

}  // namespace chiaro

#include "illumination/sh/rotation.h"

#include <numbers>

#include "illumination/sh/quadrature.h"

namespace chiaro {

Axes nearest_orthogonal(Axes map) {
    for (int step = 0; step < 20; ++step) {
        const auto& [a, b, c] = map;
        const double det = dot(a, cross(b, c));
        const Axes inverse_transposed{(1 / det) * cross(b, c), (1 / det) * cross(c, a), (1 / det) * cross(a, b)};
        for (int k = 0; k < 3; ++k) map[k] = 0.5 * (map[k] + inverse_transposed[k]);
    }
    return map;
}

ShRotation::ShRotation(const Axes& map) {
    constexpr int azimuths = 8;
    for (const auto [z, weight] : gauss_legendre)
        for (int k = 0; k < azimuths; ++k) {
            const double phi = 2 * std::numbers::pi * k / azimuths, r = std::sqrt(1 - z * z);
            const Vec3 d{r * std::cos(phi), r * std::sin(phi), z};
            const ShCoefficients before = spherical_harmonics(d), after = spherical_harmonics(turned(map, d));
            for (int l = 0; l < max_bands; ++l)
                for (int m = l * l; m < (l + 1) * (l + 1); ++m)
                    for (int n = l * l; n < (l + 1) * (l + 1); ++n)
                        matrix_[m][n] += weight * 2 * std::numbers::pi / azimuths * after[m] * before[n];
        }
}

}  // namespace chiaro

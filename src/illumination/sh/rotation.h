// Functions on the sphere turned or mirrored: exact, band by band.
#pragma once
#include "illumination/sh/basis.h"

namespace chiaro {

using ShCoefficients = std::array<double, max_coefficients>;  ///< index l (l + 1) + m

/// An orthogonal map by the images of x, y and z, its matrix's columns; reflections count.
using Axes = std::array<Vec3, 3>;

inline Vec3 turned(const Axes& map, Vec3 d) { return d.x * map[0] + d.y * map[1] + d.z * map[2]; }
/// The inverse of an orthogonal map.
inline Axes transposed(const Axes& m) {
    return {{{m[0].x, m[1].x, m[2].x}, {m[0].y, m[1].y, m[2].y}, {m[0].z, m[1].z, m[2].z}}};
}
/// First `inner`, then `outer`.
inline Axes composed(const Axes& outer, const Axes& inner) {
    return {turned(outer, inner[0]), turned(outer, inner[1]), turned(outer, inner[2])};
}

/// The orthogonal map nearest to a regular one: the factor Q of its polar decomposition M = Q S, by Newton's iteration
/// Q ← (Q + Q⁻ᵀ) / 2 (Higham 1986).
Axes nearest_orthogonal(Axes map);

/// The matrices of an orthogonal map R over the coefficients of each band: g(R ω) = f(ω). As the bands are invariant
/// spaces, D_mn = ∫ Y_m(R ω) Y_n(ω) dω, a polynomial of degree 2 l <= 6 that a quadrature of 4 × 8 points integrates
/// exactly. Cost: some 10 µs, then 84 products for each function.
class ShRotation {
public:
    explicit ShRotation(const Axes& map);

    /// The coefficients of g from those of f; `Number` float or double.
    template <class Number>
    std::array<Number, max_coefficients> operator()(const std::array<Number, max_coefficients>& f) const {
        std::array<Number, max_coefficients> g{};
        for (int l = 0; l < max_bands; ++l)
            for (int m = l * l; m < (l + 1) * (l + 1); ++m)
                for (int n = l * l; n < (l + 1) * (l + 1); ++n) g[m] += Number(matrix_[m][n]) * f[n];
        return g;
    }

private:
    std::array<ShCoefficients, max_coefficients> matrix_{};  ///< zero between different bands
};

}  // namespace chiaro

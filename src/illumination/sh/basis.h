// Real orthonormal spherical harmonics of the first four bands, without the Condon-Shortley sign; index l (l + 1) + m.
#pragma once
#include <chiaro/geometry.h>

#include <array>

namespace chiaro {

inline constexpr int max_bands = 4, max_coefficients = max_bands * max_bands;

/// Y_lm of a unit vector. Y_1 = √(3/4π) (y, z, x).
inline std::array<double, max_coefficients> spherical_harmonics(Vec3 d) {
    const double x = d.x, y = d.y, z = d.z;
    return {0.28209479177387814,
            0.4886025119029199 * y,
            0.4886025119029199 * z,
            0.4886025119029199 * x,
            1.0925484305920792 * x * y,
            1.0925484305920792 * y * z,
            0.31539156525252005 * (3 * z * z - 1),
            1.0925484305920792 * x * z,
            0.5462742152960396 * (x * x - y * y),
            0.5900435899266435 * y * (3 * x * x - y * y),
            2.890611442640554 * x * y * z,
            0.4570457994644658 * y * (5 * z * z - 1),
            0.3731763325901154 * z * (5 * z * z - 3),
            0.4570457994644658 * x * (5 * z * z - 1),
            1.445305721320277 * z * (x * x - y * y),
            0.5900435899266435 * x * (x * x - 3 * y * y)};
}

/// B_lm = ∫ max(0, Y_lm): no transmittance, 0 to 1 in every direction, has a coefficient beyond it (band 0: below 0).
inline constexpr std::array<double, max_coefficients> coefficient_bounds{3.5449, 1.5350, 1.5350, 1.5350, 1.4567, 1.4567,
                                                                         1.5254, 1.4567, 1.4567, 1.3903, 1.4453, 1.4268,
                                                                         1.5241, 1.4268, 1.4453, 1.3903};

}  // namespace chiaro

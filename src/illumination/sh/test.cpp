// Spherical harmonics: their rotation against what it stands for, and the windows.
#include <gtest/gtest.h>

#include <random>

#include "illumination/sh/directions.h"
#include "illumination/sh/rotation.h"
#include "illumination/sh/window.h"

using namespace chiaro;

namespace {

/// Any rotation, from a quaternion; mirrored where asked.
Axes some_map(unsigned seed, bool mirrored = false) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    const double n = std::sqrt(w * w + x * x + y * y + z * z);
    w /= n, x /= n, y /= n, z /= n;
    Axes map{{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
              {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
              {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
    if (mirrored) map[1] = -map[1];
    return map;
}

ShCoefficients some_function(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    ShCoefficients c;
    for (double& value : c) value = normal(random);
    return c;
}

double value_of(const ShCoefficients& c, Vec3 d) {
    const ShCoefficients y = spherical_harmonics(d);
    double sum = 0;
    for (int i = 0; i < max_coefficients; ++i) sum += c[i] * y[i];
    return sum;
}

void expect_near(const ShCoefficients& a, const ShCoefficients& b, double tolerance) {
    for (int i = 0; i < max_coefficients; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

}  // namespace

TEST(ShBasis, IsOrthonormal) {
    // The quadrature that rotations rely on: exact for products of two functions.
    const ShRotation identity({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    for (int i = 0; i < max_coefficients; ++i) {
        ShCoefficients unit{};
        unit[i] = 1;
        expect_near(identity(unit), unit, 1e-14);
    }
}

TEST(ShRotation, MovesTheFunction) {
    for (const bool mirrored : {false, true})
        for (unsigned seed = 1; seed <= 5; ++seed) {
            const Axes map = some_map(seed, mirrored);
            const ShCoefficients f = some_function(seed), g = ShRotation(map)(f);
            for (const Vec3 d : fibonacci_directions(50))
                EXPECT_NEAR(value_of(g, turned(map, d)), value_of(f, d), 1e-12);
        }
}

TEST(ShRotation, KeepsTheEnergyOfEachBand) {
    const ShCoefficients f = some_function(3), g = ShRotation(some_map(4))(f);
    for (int l = 0; l < max_bands; ++l) {
        double before = 0, after = 0;
        for (int i = l * l; i < (l + 1) * (l + 1); ++i) before += f[i] * f[i], after += g[i] * g[i];
        EXPECT_NEAR(after, before, 1e-12 * before) << l;
    }
}

TEST(ShRotation, ComposesAndInverts) {
    const Axes a = some_map(5), b = some_map(6, true);
    const ShCoefficients f = some_function(7);
    expect_near(ShRotation(composed(a, b))(f), ShRotation(a)(ShRotation(b)(f)), 1e-12);
    expect_near(ShRotation(transposed(b))(ShRotation(b)(f)), f, 1e-12);
}

TEST(ShRotation, MirrorsAtAPlane) {
    // y → -y changes the sign of what is odd in y: m < 0.
    const ShRotation mirror({{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}});
    const ShCoefficients f = some_function(8), g = mirror(f);
    for (int l = 0; l < max_bands; ++l)
        for (int m = -l; m <= l; ++m) EXPECT_NEAR(g[l * (l + 1) + m], (m < 0 ? -1 : 1) * f[l * (l + 1) + m], 1e-13);
}

TEST(NearestOrthogonal, KeepsOrthogonalMapsAndStraightensOthers) {
    const Axes map = some_map(9, true), same = nearest_orthogonal(map);
    for (int k = 0; k < 3; ++k) EXPECT_LT(length(same[k] - map[k]), 1e-14);
    // Two axes that lean towards each other are bent apart by the same angle.
    const double lean = 0.2;
    const Axes straight = nearest_orthogonal({{{std::cos(lean), std::sin(lean), 0}, {0, 1, 0}, {0, 0, 1}}});
    EXPECT_NEAR(straight[0].y, std::sin(lean / 2), 1e-12);
    EXPECT_NEAR(straight[1].x, -std::sin(lean / 2), 1e-12);
}

TEST(ShWindow, FactorsAreThoseOfTheFormula) {
    for (const ShWindow window : {ShWindow::none, ShWindow::hann, ShWindow::lanczos}) {
        const auto four = window_factors(window, 4), two = window_factors(window, 2);
        EXPECT_EQ(four[0], 1);
        EXPECT_EQ(two[2], 0);
        for (int l = 1; l < 4; ++l) EXPECT_LE(four[l], four[l - 1]);
    }
    EXPECT_EQ(window_factors(ShWindow::none, 4)[3], 1);
    EXPECT_NEAR(window_factors(ShWindow::hann, 4)[2], 0.5, 1e-15);
    EXPECT_NEAR(window_factors(ShWindow::hann, 2)[1], 0.5, 1e-15);
    EXPECT_NEAR(window_factors(ShWindow::lanczos, 4)[2], 2 / std::numbers::pi, 1e-15);
}

// How near each interpolation comes to Marschner's and Lobb's signal (1994): the surface of ½, and its normals.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "classify/medium.h"
#include "fixtures.h"
#include "volume/device_view.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr int size = 41;
constexpr double alpha = 0.25, half = (size - 1) / 2.0, pi = std::numbers::pi;

double ring(double r) { return std::cos(12 * pi * std::cos(pi * r / 2)); }
double signal(double x, double y, double z) {
    return (1 - std::sin(pi * z / 2) + alpha * (1 + ring(std::hypot(x, y)))) / (2 * (1 + alpha));
}
/// The surface of ½, where the signal is 1 - sin(πz/2) + α (1 + ring) = 1 + α.
double height(double x, double y) { return 2 / pi * std::asin(alpha * ring(std::hypot(x, y))); }
Vec3 slope(double x, double y, double z) {
    constexpr double d = 1e-5;
    return {(signal(x + d, y, z) - signal(x - d, y, z)) / (2 * d),
            (signal(x, y + d, z) - signal(x, y - d, z)) / (2 * d),
            (signal(x, y, z + d) - signal(x, y, z - d)) / (2 * d)};
}

struct Errors {
    double distance = 0, angle_deg = 0;  ///< RMS; voxels
    double own_angle_deg = 0;            ///< of the reconstruction's own gradient
};

Errors errors_of(Interpolation interpolation) {
    const Volume volume = sampled<float>({size, size, size}, [](double x, double y, double z) {
        return signal(x / half - 1, y / half - 1, z / half - 1);
    });
    const Medium medium = classify(upload(tested_device(), volume), constant(1), {.interpolation = interpolation});
    const auto view = view_of<float>(medium.data().volume.data());
    using Point = kernel::Vec3<float>;
    const auto locate = [&](Point p) { return view.locate(p, view.voxel(p)); };
    Errors errors;
    int count = 0;
    for (double y = -0.8; y <= 0.8; y += 0.0137)
        for (double x = -0.8; x <= 0.8; x += 0.0137) {
            const double truth = height(x, y);
            double below = truth - 0.2, above = truth + 0.2;  // the signal falls with z
            const auto at = [&](double z) {
                return Point{float((x + 1) * half), float((y + 1) * half), float((z + 1) * half)};
            };
            for (int i = 0; i < 30; ++i) {
                const double z = (below + above) / 2;
                (view.value(locate(at(z))) > 0.5f ? below : above) = z;
            }
            const Vec3 n = normalized(slope(x, y, truth));
            const Point g = view.gradient(locate(at(below)));
            const Vec3 found = normalized(Vec3{g.x, g.y, g.z});
            errors.distance += std::pow((below - truth) * half * n.z, 2);
            errors.angle_deg += std::pow(std::acos(std::min(1.0, dot(found, n))) * 180 / pi, 2);
            const auto along = [&](Point d) {
                const Point p = at(below);
                return double(view.value(locate(p + d)) - view.value(locate(p - d)));
            };
            constexpr float d = 0.02f;
            const Vec3 own = normalized(Vec3{along({d, 0, 0}), along({0, d, 0}), along({0, 0, d})});
            errors.own_angle_deg += std::pow(std::acos(std::min(1.0, dot(own, n))) * 180 / pi, 2);
            ++count;
        }
    const auto rms = [&](double sum) { return std::sqrt(sum / count); };
    return {rms(errors.distance), rms(errors.angle_deg), rms(errors.own_angle_deg)};
}

}  // namespace

TEST(MarschnerLobb, CubicIsNearestToTheSurface) {
    const Errors linear = errors_of(Interpolation::linear), cubic = errors_of(Interpolation::cubic),
                 smooth = errors_of(Interpolation::smooth);
    if (std::getenv("CHIARO_SHOW"))
        for (const auto& [name, e] : {std::pair("linear", linear), {"cubic", cubic}, {"smooth", smooth}})
            fmt::print("{}: surface {:.3f} voxels, normals {:.1f} degrees, by its own gradient {:.1f} (RMS)\n", name,
                       e.distance, e.angle_deg, e.own_angle_deg);
    EXPECT_LT(cubic.distance, 0.5 * linear.distance);
    EXPECT_GT(smooth.distance, linear.distance);
    EXPECT_LT(cubic.angle_deg, linear.angle_deg + 0.1);
}

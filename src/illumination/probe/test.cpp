// Light probes: projection, placement in the world, irradiance, importance.
#include <chiaro/error.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "illumination/reference/directions.h"

using namespace chiaro;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180;

/// A picture of a function of direction, in the probe's own frame.
Probe pictured(int width, int height, const std::function<Rgb(Vec3)>& radiance) {
    ProbePicture picture{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const double channel : radiance(picture.direction(x + 0.5, y + 0.5)))
                picture.rgb.push_back(float(channel));
    return Probe(width, height, std::move(picture.rgb));
}

/// One bright pixel; its solid angle and direction in the probe's frame.
struct Source {
    Probe probe;
    double azimuth, elevation, solid_angle;
};
Source narrow_source(int width, int height, int x, int y, Rgb rgb = {1, 1, 1}) {
    std::vector<float> pixels(std::size_t(3) * width * height);
    for (int c = 0; c < 3; ++c) pixels[3 * (std::size_t(y) * width + x) + c] = float(rgb[c]);
    Source source{Probe(width, height, std::move(pixels)), 0, 0, 0};
    const ProbePicture& picture = source.probe.data().picture;
    source.azimuth = picture.azimuth(x + 0.5);
    source.elevation = pi / 2 - picture.polar_angle(y + 0.5);
    source.solid_angle = 2 * pi / width * (std::cos(picture.polar_angle(y)) - std::cos(picture.polar_angle(y + 1)));
    return source;
}

double mean_luminance(const Probe& probe) {
    double luminance = 0;
    for (int c = 0; c < 3; ++c) luminance += luminance_weights[c] * probe.data().sh[c][0] / std::sqrt(4 * pi);
    return luminance;
}

Lighting lit_by(Probe probe, double rotation = 0, double stops = 0) {
    Lighting lighting;
    lighting.loaded_probe = std::move(probe);
    lighting.probe.rotation_deg = rotation, lighting.probe.exposure_stops = stops;
    return lighting;
}

Geometry oblique_grid(bool left_handed) {
    Geometry geometry;
    const double a = 0.4, b = 1.1;
    const Vec3 x{std::cos(a), std::sin(a), 0}, y{-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)};
    geometry.direction = {x, y, left_handed ? cross(y, x) : cross(x, y)};
    geometry.spacing_mm = {0.5, 2, 1};
    return geometry;
}

}  // namespace

TEST(Probe, RefusesWhatIsNoPicture) {
    EXPECT_THROW(Probe(0, 1, {}), Error);
    EXPECT_THROW(Probe(2, 1, {1, 2, 3}), Error);
    EXPECT_FALSE(Probe());
    EXPECT_EQ(Probe().width(), 0);
}

TEST(Probe, MendsValuesThatLightCannotHave) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const Probe probe(2, 1, {inf, -inf, nan, -1, 0.5f, 1e30f});
    const std::vector<float> expected{65504, 0, 0, 0, 0.5f, 1e30f};
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), probe.rgb().begin()));
}

TEST(Probe, OfConstantLightHasBandZeroAlone) {
    const Rgb rgb{1, 2, 0.5};
    for (auto [width, height] : {std::pair(1, 1), {8, 4}, {5, 3}, {200, 100}}) {
        const Probe probe = pictured(width, height, [&](Vec3) { return rgb; });
        for (int c = 0; c < 3; ++c)
            for (int i = 0; i < most_coefficients; ++i)
                EXPECT_NEAR(probe.data().sh[c][i], i ? 0 : rgb[c] * std::sqrt(4 * pi), 1e-9) << i;
    }
}

TEST(Probe, OfAHarmonicHasThatCoefficient) {
    for (int wanted = 0; wanted < most_coefficients; ++wanted) {
        const Probe probe = pictured(256, 128, [&](Vec3 d) {
            const double y = spherical_harmonics(d)[wanted];
            return Rgb{2 + y, 2 - y, 2};
        });
        for (int i = 1; i < most_coefficients; ++i) {
            EXPECT_NEAR(probe.data().sh[0][i], i == wanted, 1e-3) << wanted << " " << i;
            EXPECT_NEAR(probe.data().sh[1][i], -(i == wanted), 1e-3);
            EXPECT_NEAR(probe.data().sh[2][i], 0, 1e-3);
        }
    }
}

TEST(Probe, OfANarrowSourceIsADelta) {
    const Source s = narrow_source(720, 360, 100, 80);
    const ShCoefficients y = spherical_harmonics(orbit_direction(s.azimuth, s.elevation, {0, 0, 1}));
    for (int i = 0; i < most_coefficients; ++i) EXPECT_NEAR(s.probe.data().sh[0][i] / s.solid_angle, y[i], 1e-4) << i;
}

TEST(BuiltinProbe, IsFinitePositiveAndOfLuminanceOne) {
    for (const ProbeInfo& info : list_probes()) {
        const Probe probe = builtin_probe(info.name);
        for (const float radiance : probe.rgb()) ASSERT_TRUE(radiance > 0 && radiance < 1e4) << info.name;
        EXPECT_NEAR(mean_luminance(probe), 1, 1e-5) << info.name;
    }
    EXPECT_EQ(builtin_probe("white").rgb()[0], 1);
}

TEST(BuiltinProbe, LightsFromWhereItSays) {
    const auto light = [](const char* name) {
        return sh_light(lit_by(builtin_probe(name)), {0, 0, 1}, {}, ShWindow::none);
    };
    EXPECT_LT(light("white").directionality, 1e-9);
    EXPECT_GT(light("sky").dominant.z, 0.5);
    EXPECT_GT(light("studio").directionality, 0.5);
    EXPECT_GT(dot(light("studio").dominant, orbit_direction(-25 * degree, 38 * degree, {0, 0, 1})), 0.8);
    EXPECT_GT(light("sky").directionality, 0.3);
    EXPECT_LT(light("windows").directionality, 0.3);
}

TEST(ShLight, FindsANarrowSourceInTheWorld) {
    const Source s = narrow_source(360, 180, 130, 50, {3, 2, 1});
    for (const Vec3 up : {Vec3{0, 0, 1}, {0, -1, 0}, {-2, 0, 0}, {0.3, 0.5, -0.8}})
        for (const double rotation : {0.0, 75.0, -200.0})
            for (const bool left_handed : {false, true}) {
                const Geometry geometry = oblique_grid(left_handed);
                const ShLight light = sh_light(lit_by(s.probe, rotation), up, geometry, ShWindow::none);
                const Vec3 expected = orbit_direction(s.azimuth + rotation * degree, s.elevation, up);
                EXPECT_LT(length(light.dominant - expected), 1e-4);
                EXPECT_NEAR(light.directionality, 1, 1e-4);
                // In the axes of the grid: the component along each of them.
                const auto& [x, y, z] = geometry.direction;
                const ShCoefficients basis =
                    spherical_harmonics({dot(expected, x), dot(expected, y), dot(expected, z)});
                for (int c = 0; c < 3; ++c)
                    for (int i = 0; i < most_coefficients; ++i)
                        EXPECT_NEAR(light.coefficients[c][i] / s.solid_angle, (3 - c) * basis[i], 2e-3) << i;
            }
}

TEST(ShLight, TurnedIsTheProjectionOfTheTurnedPicture) {
    const auto radiance = [](Vec3 d) { return Rgb{std::exp(d.x + d.z), 1 + d.y * d.y, std::exp(2 * d.y)}; };
    const double turn = 40 * degree;
    const Probe plain = pictured(512, 256, radiance),
                turned_one = pictured(512, 256, [&](Vec3 d) {
                    return radiance({std::cos(turn) * d.x + std::sin(turn) * d.y,
                                     std::cos(turn) * d.y - std::sin(turn) * d.x, d.z});
                });
    const ShLight a = sh_light(lit_by(plain, 40), {0, 0, 1}, {}, ShWindow::none);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < most_coefficients; ++i)
            EXPECT_NEAR(a.coefficients[c][i], turned_one.data().sh[c][i], 1e-4) << i;
}

TEST(ShLight, ExposureAndWindowAreFactors) {
    const Probe probe = builtin_probe("sky");
    const ShLight plain = sh_light(lit_by(probe), {0, 0, 1}, {}, ShWindow::none);
    const ShLight bright = sh_light(lit_by(probe, 0, 3), {0, 0, 1}, {}, ShWindow::none);
    const ShLight soft = sh_light(lit_by(probe), {0, 0, 1}, {}, ShWindow::hann),
                  few = sh_light(lit_by(probe), {0, 0, 1}, {}, ShWindow::hann, 2);
    for (int i = 0; i < most_coefficients; ++i) {
        EXPECT_DOUBLE_EQ(bright.coefficients[0][i], 8 * plain.coefficients[0][i]);
        const int band = int(std::sqrt(i));
        EXPECT_NEAR(soft.coefficients[0][i], (1 + std::cos(pi * band / 4)) / 2 * plain.coefficients[0][i], 1e-12);
        EXPECT_NEAR(few.coefficients[0][i], band < 2 ? (1 + std::cos(pi * band / 2)) / 2 * plain.coefficients[0][i] : 0,
                    1e-12);
    }
    EXPECT_DOUBLE_EQ(bright.mean[1], 8 * plain.mean[1]);
    EXPECT_EQ(soft.dominant, plain.dominant);
    EXPECT_EQ(soft.directionality, plain.directionality);
}

TEST(ShLight, WithoutAProbeIsWhite) {
    const ShLight light = sh_light({}, {0, 1, 0}, oblique_grid(true), ShWindow::none);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < most_coefficients; ++i)
            EXPECT_NEAR(light.coefficients[c][i], i ? 0 : std::sqrt(4 * pi), 1e-9);
    EXPECT_EQ(light.dominant, (Vec3{0, 1, 0}));
    EXPECT_EQ(light.directionality, 0);
    EXPECT_NEAR(light.mean[2], 1, 1e-9);
}

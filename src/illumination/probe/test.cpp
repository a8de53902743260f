// Light probes: projection, placement in the world, irradiance.
#include <chiaro/error.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "illumination/probe/data.h"
#include "illumination/probe/light.h"
#include "illumination/sh/directions.h"

using namespace chiaro;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180;

/// A picture of a function of direction, in the probe's own frame.
Probe pictured(int width, int height, const std::function<Rgb(Vec3)>& radiance) {
    ProbeImage image{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const double channel : radiance(image.direction(x + 0.5, y + 0.5)))
                image.rgb.push_back(float(channel));
    return Probe(width, height, std::move(image.rgb));
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
    const ProbeImage& image = source.probe.data().image;
    source.azimuth = image.azimuth(x + 0.5);
    source.elevation = pi / 2 - image.polar_angle(y + 0.5);
    source.solid_angle = image.solid_angle(y);
    return source;
}

Lighting lit_by(Probe probe, double rotation = 0, double stops = 0) {
    Lighting lighting;
    lighting.loaded_probe = std::move(probe);
    lighting.probe.rotation_deg = rotation, lighting.probe.exposure = stops;
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

TEST(Probe, RefusesWhatIsNoImage) {
    EXPECT_THROW(Probe(0, 1, {}), Error);
    EXPECT_THROW(Probe(2, 1, {1, 2, 3}), Error);
    EXPECT_THROW(Probe(65537, 1, std::vector<float>(3 * 65537)), Error);
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
            for (int i = 0; i < max_coefficients; ++i)
                EXPECT_NEAR(probe.data().sh[c][i], i ? 0 : rgb[c] * std::sqrt(4 * pi), 1e-9) << i;
    }
}

TEST(Probe, OfAHarmonicHasThatCoefficient) {
    for (int wanted = 0; wanted < max_coefficients; ++wanted) {
        const Probe probe = pictured(256, 128, [&](Vec3 d) {
            const double y = spherical_harmonics(d)[wanted];
            return Rgb{2 + y, 2 - y, 2};
        });
        for (int i = 1; i < max_coefficients; ++i) {
            EXPECT_NEAR(probe.data().sh[0][i], i == wanted, 1e-3) << wanted << " " << i;
            EXPECT_NEAR(probe.data().sh[1][i], -(i == wanted), 1e-3);
            EXPECT_NEAR(probe.data().sh[2][i], 0, 1e-3);
        }
    }
}

TEST(Probe, OfANarrowSourceIsADelta) {
    const Source s = narrow_source(720, 360, 100, 80);
    const ShCoefficients y = spherical_harmonics(orbit_direction(s.azimuth, s.elevation, {0, 0, 1}));
    for (int i = 0; i < max_coefficients; ++i) EXPECT_NEAR(s.probe.data().sh[0][i] / s.solid_angle, y[i], 1e-4) << i;
}

TEST(BuiltinProbe, IsFiniteAndPositiveAndLightsAWhiteSurfaceUpToOne) {
    for (const ProbeInfo& info : list_probes()) {
        const Probe probe = builtin_probe(info.name);
        for (const float radiance : probe.rgb()) ASSERT_TRUE(radiance > 0 && radiance < 1e4) << info.name;
        const LambertTable& table = probe.data().lambert();
        double brightest = 0;  // V = 1: c_00 = √4π
        for (const LambertTable::Entry& entry : table.entries) {
            double luminance = 0;
            for (int c = 0; c < 3; ++c) luminance += luminance_weights[c] * entry[c][0] * std::sqrt(4 * pi) / pi;
            brightest = std::max(brightest, luminance);
        }
        EXPECT_NEAR(brightest, 1, 0.002) << info.name;
    }
    EXPECT_NEAR(builtin_probe("white").rgb()[0], 1, 1e-5);
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
    EXPECT_LT(light("windows").directionality, 0.4);
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
                    for (int i = 0; i < max_coefficients; ++i)
                        EXPECT_NEAR(light.coefficients[c][i] / s.solid_angle, (3 - c) * basis[i], 2e-3) << i;
            }
}

TEST(ShLight, TurnedIsTheProjectionOfTheTurnedImage) {
    const auto radiance = [](Vec3 d) { return Rgb{std::exp(d.x + d.z), 1 + d.y * d.y, std::exp(2 * d.y)}; };
    const double turn = 40 * degree;
    const Probe plain = pictured(512, 256, radiance),
                turned_one = pictured(512, 256, [&](Vec3 d) {
                    return radiance({std::cos(turn) * d.x + std::sin(turn) * d.y,
                                     std::cos(turn) * d.y - std::sin(turn) * d.x, d.z});
                });
    const ShLight a = sh_light(lit_by(plain, 40), {0, 0, 1}, {}, ShWindow::none);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < max_coefficients; ++i)
            EXPECT_NEAR(a.coefficients[c][i], turned_one.data().sh[c][i], 1e-4) << i;
}

TEST(ShLight, ExposureAndWindowAreFactors) {
    const Probe probe = builtin_probe("sky");
    const ShLight plain = sh_light(lit_by(probe), {0, 0, 1}, {}, ShWindow::none);
    const ShLight bright = sh_light(lit_by(probe, 0, 3), {0, 0, 1}, {}, ShWindow::none);
    const ShLight soft = sh_light(lit_by(probe), {0, 0, 1}, {}, ShWindow::hann),
                  few = sh_light(lit_by(probe), {0, 0, 1}, {}, ShWindow::hann, 2);
    for (int i = 0; i < max_coefficients; ++i) {
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
        for (int i = 0; i < max_coefficients; ++i)
            EXPECT_NEAR(light.coefficients[c][i], i ? 0 : std::sqrt(4 * pi), 1e-9);
    EXPECT_EQ(light.dominant, (Vec3{0, 1, 0}));
    EXPECT_EQ(light.directionality, 0);
    EXPECT_NEAR(light.mean[2], 1, 1e-9);
}

namespace {

/// ∫ L max(0, n·ω) V(ω) dω over the picture, pixel by pixel; V in spherical harmonics, in the probe's frame.
Rgb irradiance(const Probe& probe, Vec3 normal, const ShCoefficients& visibility) {
    const ProbeImage& image = probe.data().image;
    Rgb sum{};
    for (int y = 0; y < image.height; ++y) {
        const double solid_angle = image.solid_angle(y);
        for (int x = 0; x < image.width; ++x) {
            const Vec3 d = image.direction(x + 0.5, y + 0.5);
            const double cosine = dot(normal, d);
            if (cosine <= 0) continue;
            const ShCoefficients basis = spherical_harmonics(d);
            double v = 0;
            for (int i = 0; i < max_coefficients; ++i) v += visibility[i] * basis[i];
            const float* pixel = image.rgb.data() + 3 * (std::size_t(y) * image.width + x);
            for (int c = 0; c < 3; ++c) sum[c] += solid_angle * cosine * v * pixel[c];
        }
    }
    return sum;
}

Rgb product(const LambertTable::Entry& entry, const ShCoefficients& visibility) {
    Rgb sum{};
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < max_coefficients; ++i) sum[c] += visibility[i] * entry[c][i];
    return sum;
}

const ShCoefficients all_open{std::sqrt(4 * pi)};

/// What is open on one side of a plane: √π, √(3π)/2, 0, -√(7π)/8 along its normal.
ShCoefficients half_open(Vec3 normal) {
    const ShCoefficients along{std::sqrt(pi),         0, std::sqrt(3 * pi) / 2, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                               -std::sqrt(7 * pi) / 8};
    const Vec3 x = normalized(cross(normal, std::abs(normal.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    return ShRotation({x, cross(normal, x), normal})(along);
}

}  // namespace

/// A sun is one light, soft boxes are parts of as much light each, whose rays lie within them; what shines from
/// everywhere has none.
TEST(Lamps, AreWhatStandsOut) {
    const auto lamps = [](const char* name, double rotation = 0) {
        return lamps_of(lit_by(builtin_probe(name), rotation), {0, 0, 1}, {});
    };
    EXPECT_TRUE(lamps("white").empty());
    ASSERT_EQ(lamps("sky").size(), 1u);
    EXPECT_EQ(lamps("sky")[0].size(), 1u);
    const auto studio = lamps("studio"), turned_one = lamps("studio", 70);
    ASSERT_EQ(studio.size(), 2u);
    const Vec3 key = orbit_direction(-25 * degree, 38 * degree, {0, 0, 1});
    double all = 0;
    for (const Lamp& lamp : studio) {
        ASSERT_EQ(lamp.size(), std::size_t(lamp_parts));
        for (const auto& [light, rays] : lamp) {
            EXPECT_NEAR(light.light[1] / lamp[0].light.light[1], 1, 0.1);
            EXPECT_EQ(rays.size(), std::size_t(rays_per_part));
            all += light.light[1];
        }
    }
    for (const auto& [light, rays] : studio[0])
        for (const Vec3 ray : rays) EXPECT_GT(dot(ray, key), std::cos(33 * degree));
    const double mean = sh_light(lit_by(builtin_probe("studio")), {0, 0, 1}, {}, ShWindow::none).mean[1];
    EXPECT_GT(all, 0.85 * mean);
    EXPECT_LT(all, mean);
    const Vec3 first = studio[0][0].light.direction;
    EXPECT_LT(length(turned_one[0][0].light.direction -
                     orbit_direction(std::atan2(first.y, first.x) + 70 * degree, std::asin(first.z), {0, 0, 1})),
              1e-9);
}

/// A wide lamp's brightest place is no sun.
TEST(Lamps, HaveNoSunInTheirCorner) {
    const Probe lamp = pictured(360, 180, [](Vec3 d) {
        const bool in = d.x > 0 && std::abs(d.y) < 0.4 * d.x && std::abs(d.z - 0.5 * d.x) < 0.3 * d.x;
        return in ? Rgb{9, 9, 9} : Rgb{0, 0, 0};
    });
    const auto found = lamps_of(lit_by(lamp), {0, 0, 1}, {});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].size(), std::size_t(lamp_parts));
}

TEST(Lambert, GivesTheIrradianceOfTheWholeImage) {
    for (const char* name : {"sky", "studio", "windows", "three-point"}) {
        const Probe probe = builtin_probe(name);
        const LambertTable table = lambert_table(lit_by(probe), {0, 0, 1}, {}, ShWindow::none);
        double worst = 0, largest = 0;
        for (const Vec3 normal : fibonacci_directions(12))
            for (const ShCoefficients& visibility : {all_open, half_open(normal), half_open({0.6, 0, 0.8})}) {
                const Rgb exact = irradiance(probe, normal, visibility), found = product(table.at(normal), visibility);
                for (int c = 0; c < 3; ++c) {
                    worst = std::max(worst, std::abs(found[c] - exact[c]));
                    largest = std::max(largest, exact[c]);
                }
            }
        RecordProperty(name, std::to_string(worst / largest));
        EXPECT_LT(worst, 0.01 * largest) << name;
    }
}

TEST(Lambert, OfWhiteLightIsTheCosineLobe) {
    // ∫ max(0, n·ω) dω = π; the lobe's bands are π, 2π/3, π/4, 0 times Y_lm(n).
    const LambertTable table = lambert_table({}, {0, 0, 1}, {}, ShWindow::none);
    const double bands[] = {pi, 2 * pi / 3, pi / 4, 0};
    for (const Vec3 normal : fibonacci_directions(100)) {
        const ShCoefficients basis = spherical_harmonics(normal);
        const auto entry = table.at(normal);
        for (int l = 0; l < max_bands; ++l)
            for (int i = l * l; i < (l + 1) * (l + 1); ++i) EXPECT_NEAR(entry[1][i], bands[l] * basis[i], 0.01) << i;
    }
}

TEST(Lambert, StandsInTheWorldAsTheLightDoes) {
    const Probe probe = builtin_probe("studio");
    const Vec3 up{0.3, 0.5, -0.8};
    double worst = 0, largest = 0;
    for (const bool left_handed : {false, true}) {
        const Geometry geometry = oblique_grid(left_handed);
        const Lighting lighting = lit_by(probe, 75, 1);
        const LambertTable table = lambert_table(lighting, up, geometry, ShWindow::none);
        const Axes probe_from_grid = transposed(composed(grid_from_world(geometry), world_from_probe(75, up)));
        const ShCoefficients visibility = half_open({0, 0.6, 0.8});
        const ShCoefficients in_probe = ShRotation(probe_from_grid)(visibility);
        for (const Vec3 normal : fibonacci_directions(25)) {
            const Rgb exact = irradiance(probe, turned(probe_from_grid, normal), in_probe);
            const Rgb found = product(table.at(normal), visibility);
            for (int c = 0; c < 3; ++c) {
                worst = std::max(worst, std::abs(found[c] - 2 * exact[c]));
                largest = std::max(largest, 2 * exact[c]);
            }
        }
    }
    RecordProperty("error", std::to_string(worst / largest));
    EXPECT_LT(worst, 0.01 * largest);
}

TEST(Lambert, HasNoSeamAtTheFolds) {
    const LambertTable table = lambert_table(lit_by(builtin_probe("studio")), {0, 0, 1}, {}, ShWindow::none);
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    double scale = 0, worst = 0;
    for (int i = 0; i < 2000; ++i) {
        Vec3 n{normal(random), normal(random), normal(random)};
        if (i % 4 < 3) n[i % 4] *= 1e-5;  // on both sides of a fold
        const auto a = table.at(n), b = table.at(n + 1e-4 * Vec3{normal(random), normal(random), normal(random)});
        for (int k = 0; k < max_coefficients; ++k) {
            scale = std::max(scale, std::abs(double(a[0][k])));
            worst = std::max(worst, std::abs(double(a[0][k]) - b[0][k]));
        }
    }
    EXPECT_LT(worst, 0.005 * scale);
}

TEST(Lambert, WindowAndBandsAreFactors) {
    const Lighting lighting = lit_by(builtin_probe("windows"));
    const auto plain = lambert_table(lighting, {0, 0, 1}, {}, ShWindow::none).at({1, 2, 3});
    const auto soft = lambert_table(lighting, {0, 0, 1}, {}, ShWindow::hann, 2).at({1, 2, 3});
    EXPECT_FLOAT_EQ(soft[2][0], plain[2][0]);
    EXPECT_FLOAT_EQ(soft[2][3], plain[2][3] / 2);
    EXPECT_EQ(soft[2][4], 0);
}

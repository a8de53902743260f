// Light at surfaces in the volume against sharp analytic geometry: how paths leave a skin and meet others
// (docs/theory/light.md).
#include <fmt/format.h>

#include "classify/surface_table.h"
#include "illumination/probe/data.h"
#include "sharp_geometry.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

TEST(Surfaces, ABallIsAsBrightAsItsAlbedo) {
    for (const double edge : {0.4, 0.8, 1.5, 2.0, 3.0}) {
        const auto found = [&](PathOptions options) {
            options.surfaces = true;
            return mean(irradiance_of_columns(seen(ball(edge, 22.37), at_ball(22.37), options, 64)));
        };
        EXPECT_NEAR(found({}), 1, 0.01) << edge;
        EXPECT_NEAR(found({.bounces = 0}), 1, edge < 3 ? 0.01 : 0.04) << edge;
    }
    for (const double spacing : {2.0, 4.0})
        for (const Vec3 normal : {Vec3{0.6, 0, 0.8}, Vec3{0, 0, 1}, Vec3{1, 0, 0}}) {
            const Volume volume = ball(spacing / 2, 22.37, {1, 1, spacing});
            Look look = at_ball(22.37, normal);
            EXPECT_NEAR(mean(irradiance_of_columns(seen(volume, look, {.surfaces = true}, 64))), 1, 0.02) << spacing;
        }
}

/// RMS over means of blocks of 4 x 4 pixels, relative to the mean, of a ball under half the sky, which shows
/// (1 + n · up) / 2.
double error_under_half_a_sky(double edge) {
    const Lighting half{.specular = 0, .probe = {.source = "half"}, .loaded_probe = rows_of({1, 0})};
    const Look look = at_ball(22.37, {1, 0, 0});
    const Frame frame = seen(ball(edge, 22.37), look, {.bounces = 0, .surfaces = true}, 1024, skin(), half);
    const Vec3 up = cross(look.normal, look.along);
    std::array<double, 36> errors{};
    double sum = 0;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            const double right = ((x + 0.5) / look.pixels * 2 - 1) * look.half_width,
                         top = (1 - (y + 0.5) / look.pixels * 2) * look.half_width;
            const Vec3 on = right * look.along + top * up;
            const Vec3 normal = (1 / 22.37) * (on + std::sqrt(22.37 * 22.37 - dot(on, on)) * look.normal);
            const double expected = (1 + normal.z) / 2;
            errors[std::size_t(y / 4 * 6 + x / 4)] +=
                (frame.rgba[4 * (std::size_t(y) * frame.width + x) + 1] / grey - expected) / 16;
            sum += expected;
        }
    double squares = 0;
    for (const double error : errors) squares += error * error / 36;
    return std::sqrt(squares) / (sum / (24 * 24));
}

// At .8 voxels 8 bits and central differences turn the normals.
TEST(Surfaces, ABallUnderHalfASky) {
    EXPECT_LT(error_under_half_a_sky(1.5), 0.01);
    EXPECT_LT(error_under_half_a_sky(0.8), 0.02);
}

// Albedo 1 under white light: nothing is lost, nothing is made.
TEST(Surfaces, Furnace) {
    TransferFunction white = skin();
    for (auto& point : white.points) point.rgb = {1, 1, 1};
    const PathOptions all{.albedo_max = 1, .surfaces = true};
    for (const double edge : {0.4, 0.8, 2.0}) {
        const Frame frame = seen(ball(edge, 22.37), at_ball(22.37), all, 16, white);
        for (const double column : irradiance_of_columns(frame)) EXPECT_NEAR(column * grey, 1, 0.002) << edge;
    }
    for (const Lighting& shining : {Lighting{}, Lighting{.specular = 1, .shininess = 5}, Lighting{.specular = 9}}) {
        const double light =
            grey * mean(irradiance_of_columns(seen(ball(0.8, 22.37), at_ball(22.37), all, 256, white, shining)));
        EXPECT_GT(light, 0.97) << shining.specular;
        EXPECT_LT(light, 1.002) << shining.specular;
    }
}

/// Light from one pixel of a picture of directions, seen from far away in the direction of another.
double light_from_to(const Volume& volume, const Vec3& from, const Vec3& to, int width, int pixel) {
    std::vector<float> rgb(std::size_t(width) * (width / 2) * 3, 0);
    for (int c = 0; c < 3; ++c) rgb[std::size_t(3 * pixel + c)] = 1;
    const Lighting beam{.probe = {.source = "beam"}, .loaded_probe = Probe(width, width / 2, rgb)};
    const Vec3 along = normalized(cross(to, Vec3{from.y, from.z, -from.x}));
    const Look look{centre + 60 * to, to, along, 50, 64};
    double sum = 0;
    const Frame frame = seen(volume, look, {.surfaces = true}, 256, skin(), beam);
    for (std::size_t i = 1; i < frame.rgba.size(); i += 4) sum += frame.rgba[i];
    return sum / beam.loaded_probe.data().image.solid_angle(pixel / width);
}

// What a sensor sees of a beam is what it would send there in the beam's place. A ball over a floor, highlights too.
TEST(Surfaces, BeamAndSensorMayBeSwapped) {
    const Volume volume = volume_of([&](Vec3 p) {
        const Vec3 ball = p - Vec3{31.7, 31.9, 27};
        return logistic(std::max(std::min(length(ball) - 9.3, p.z - 14.2), length(p - centre) - 27), 0.8);
    });
    constexpr int width = 36;
    const auto direction = [](int pixel) {
        return ProbeImage(width, width / 2, {}).direction(pixel % width + 0.5, pixel / width + 0.5);
    };
    for (const auto& [a, b] : {std::pair{3 * width + 4, 6 * width + 15}, {5 * width + 30, 1 * width + 9}}) {
        const double there = light_from_to(volume, direction(a), direction(b), width, a),
                     back = light_from_to(volume, direction(b), direction(a), width, b);
        EXPECT_NEAR(there / back, 1, 0.03) << a << " " << b;
    }
}

TEST(Surfaces, APlateShadowsTheFloor) {
    for (const double edge : {0.4, 0.8})
        for (const double thick : {2.0, 3.0, 5.0})
            for (const double gap : {2.0, 3.0, 4.0, 6.0, 10.0}) {
                const SharpScene under = under_plate(edge, thick, gap);
                EXPECT_NEAR(irradiance(under.volume, under.look), under.truth, 0.05)
                    << edge << " " << thick << " " << gap;
            }
}

// Slots 16 deep between sharp walls keep more light at their bottom than those with soft walls: docs/theory/light.md
// has the figures.
TEST(Surfaces, ASlotIsDarkAtItsBottom) {
    for (const auto& [edge, missing] : {std::pair{0.4, 0.015}, {0.8, 0.05}})
        for (const double wide : {2.0, 4.0, 8.0}) {
            const SharpScene bottom = bottom_of_slot(edge, wide);
            const double found = irradiance(bottom.volume, bottom.look);
            if (std::getenv("CHIARO_SHOW"))
                fmt::print("slot {} {}: {:.4f} of {:.4f}\n", edge, wide, found, bottom.truth);
            EXPECT_NEAR(found, bottom.truth, missing) << edge << " " << wide;
        }
}

// Held light must be let go before the layer.
TEST(Surfaces, ALayerShadesTheFloor) {
    for (const double edge : {0.4, 0.8})
        for (const double opacity : {0.3, 0.6})
            for (const double gap : {2.0, 4.0, 8.0}) {
                const SharpScene under = under_layer(edge, opacity, gap);
                EXPECT_NEAR(irradiance(under.volume, under.look, skin(0, 200)), under.truth, gap < 3 ? 0.09 : 0.04)
                    << edge << " " << opacity << " " << gap;
            }
}

/// The relative error of light on a wedge's wall: within two voxels of the crease, and beyond.
std::pair<double, double> errors_in(const Wedge& wedge, double edge, double noise) {
    constexpr double low = 1, high = 13;
    const Look look{centre + 1.2 * wedge.n1 + (low + high) / 2 * wedge.along, wedge.n1, wedge.along, (high - low) / 2};
    const auto found =
        irradiance_of_columns(seen(wedge.volume(edge, noise), look, {.bounces = 0, .surfaces = true}, 256));
    const auto error = [&](int from, int to) {
        double light = 0, truth = 0;
        for (int x = from; x < to; ++x) {
            light += found[std::size_t(x)];
            truth += wedge.truth(low + (x + 0.5) / look.pixels * (high - low));
        }
        if (std::getenv("CHIARO_SHOW")) fmt::print(" {:+.1f} %", 100 * (light / truth - 1));
        return std::abs(light / truth - 1);
    };
    return {error(0, 2), std::max(error(2, 6), error(6, 24))};
}

// A corner sharper than a right angle is a narrow thing of soft walls: 60 degrees are 19 to 24 % too bright at the
// crease (docs/theory/light.md).
TEST(Surfaces, AWedgeIsDarkestAtItsCrease) {
    for (const double edge : {0.4, 0.8, 1.5})
        for (const double degrees : {60.0, 90.0, 140.0}) {
            const auto [near, far] = errors_in(Wedge(degrees), edge, 0);
            EXPECT_LT(near, degrees < 90 ? 0.26 : 0.10) << edge << " " << degrees;
            EXPECT_LT(far, degrees < 90 ? 0.08 : 0.05) << edge << " " << degrees;
        }
}

// Noise of 2 % of the range, and of 5 %, which darkens soft edges (docs/theory/light.md).
TEST(Surfaces, NoiseTurnsLittle) {
    for (const double edge : {0.4, 0.8}) EXPECT_LT(errors_in(Wedge(90), edge, 5).second, 0.05) << edge;
    EXPECT_LT(errors_in(Wedge(90), 1.5, 12.5).second, 0.16);
}

// The flat face of a cut is as bright as the ball, whichever way the plane lies.
TEST(Surfaces, ACutIsASurface) {
    for (const double degrees : {0.0, 30.0, 45.0}) {
        const double a = degrees * pi / 180;
        const Vec3 normal{std::sin(a), 0, std::cos(a)};
        Shape shape;
        shape.clip.planes = {{normal, dot(normal, centre)}};
        const Look look{centre + 25 * normal, normal, {0, 1, 0}, 8};
        EXPECT_NEAR(
            mean(irradiance_of_columns(seen(ball(0.8, 22.37), look, {.surfaces = true}, 64, skin(), matte, shape))), 1,
            0.02)
            << degrees;
    }
}

// So is the volume's border in solid matter.
TEST(Surfaces, ABorderIsASurface) {
    const Volume volume = volume_of([](Vec3) { return 200.0; });
    const Vec3 middle{31.5, 31.5, 31.5};
    for (const Vec3 normal : {Vec3{0, 0, 1}, Vec3{-1, 0, 0}, Vec3{0.1, 0.2, -0.9}, Vec3{-0.2, 0.9, 0.3}}) {
        const Look look{middle + 60 * normalized(normal), normalized(normal), normalized(cross(normal, {1, 2, 4})), 8};
        EXPECT_NEAR(mean(irradiance_of_columns(seen(volume, look, {.surfaces = true}, 64))), 1, 0.01);
    }
}

/// The least and the largest share and depth of values and slopes at most a node of the table away.
struct Around {
    double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
    Around(const kernel::SurfaceView& model, double stored, double slope, double node) {
        for (int i = -4; i <= 4; ++i)
            for (int j = -4; j <= 4; ++j) {
                const auto at = model.of_slope(float(stored + i * node / 4), float(slope * std::exp2(j / 8.0)));
                const double found[] = {at.share, at.depth};
                for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], found[k]), high[k] = std::max(high[k], found[k]);
            }
    }
    double outside(int k, double found) const { return std::max({low[k] - found, found - high[k], 0.0}); }
};

// What the ray caster reads at samples is what the model says a node of the table away or nearer: of skins of many
// slopes and a few values wide, within where the transfer function changes and far beyond.
TEST(Surfaces, TheTableOfSharesIsTheModel) {
    const Volume bytes = volume_of([](Vec3 p) { return 2 * (p[0] + p[1]); });
    for (const double width : {3.0, 40.0, 200.0}) {
        TransferFunction tf;
        tf.points = {{30, {1, 1, 1}, 0}, {30 + width, {1, 1, 1}, 0.9}};
        const Medium medium = classify(upload(tested_device(), bytes), tf, {});
        const kernel::SurfaceView model = surface_table_of(medium.data())->view();
        ASSERT_TRUE(share_table_of(medium.data()));
        const kernel::ShareTableView table = share_table_of(medium.data())->view();
        const double half = 0.5 * double(medium.data().table.entries.size()) / medium.data().table.index_scale;
        std::mt19937 random(3);
        std::uniform_real_distribution<float> value(0, 255), octaves(-6, 8);
        double share = 0, share_off = 0, depth_off = 0, error = 0;
        constexpr int count = 20000;
        for (int i = 0; i < count; ++i) {
            const float stored = value(random), slope = std::exp2(octaves(random));
            const auto at = table.locate(stored, slope * slope);
            const double far = std::max(1.0, std::abs(stored - 30 - width / 2) / half);
            const Around around(model, stored, slope, 1.1 * far * half / table.per_octave);
            share_off = std::max(share_off, around.outside(0, table.share(at)));
            if (around.low[0] > 0.1) depth_off = std::max(depth_off, around.outside(1, table.depth(at)));
            const double truth = model.of_slope(stored, slope).share;
            share += truth / count, error += std::abs(table.share(at) - truth) / count;
        }
        EXPECT_GT(share, 0.05) << width;
        EXPECT_LT(share_off, 0.02) << width;
        EXPECT_LT(depth_off, 0.04) << width;
        EXPECT_LT(error, 0.03) << width;
        if (std::getenv("CHIARO_SHOW")) fmt::print("{}: {} {} {} {}\n", width, share, share_off, depth_off, error);
    }
}

}  // namespace

// Light at surfaces by visibility against sharp geometry, under white light, a sun and a lamp; that of the
// reference: surfaces_test.cpp.
// Nodes are two voxels apart: what is thinner or narrower than that they blur, and the bounds are what was found there
// (docs/theory/light.md).
#include <chiaro/render.h>
#include <fmt/format.h>

#include "sharp_geometry.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

double found_by_visibility(const SharpScene& scene, const TransferFunction& tf = skin()) {
    return brightness(shown(scene.volume, scene.look, {.method = Method::visibility}, tf));
}

void expect_near(const SharpScene& scene, double missing, const std::string& what,
                 const TransferFunction& tf = skin()) {
    const double found = found_by_visibility(scene, tf);
    if (std::getenv("CHIARO_SHOW")) fmt::print("{}: {:.3f} of {:.3f}\n", what, found, scene.truth);
    EXPECT_NEAR(found, scene.truth, missing) << what;
}

/// Not exposed: pixel by pixel (column, row) of 360 × 180.
Lighting lit_from(const std::function<float(int, int)>& radiance) {
    constexpr int width = 360, height = 180;
    std::vector<float> rgb;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) rgb.insert(rgb.end(), 3, radiance(x, y));
    Lighting lighting = matte;
    lighting.loaded_probe = Probe(width, height, std::move(rgb));
    lighting.probe.exposure = 0;
    return lighting;
}

/// A sun in the plane of y, so high above +x, in an even sky.
Lighting sun_at(double elevation_degrees) {
    const int row = int(90 - elevation_degrees);
    return lit_from(
        [&](int x, int y) { return (y == row - 1 || y == row) && (x == 179 || x == 180) ? 3000.0f : 0.1f; });
}

/// A lamp there, 36 degrees wide and 30 high, in the dark.
constexpr int lamp_width = 18, lamp_height = 15;
Lighting lamp_at(int elevation_degrees) {
    return lit_from([&](int x, int y) {
        return std::abs(x - 179.5) < lamp_width && std::abs(y - (89.5 - elevation_degrees)) < lamp_height ? 10.0f
                                                                                                          : 0.0f;
    });
}

/// On a floor, E of that lamp, but for what is below `least` in the plane of y (radians).
double light_of_lamp(int elevation_degrees, double least) {
    double sum = 0;
    for (int row = -lamp_height; row < lamp_height; ++row)
        for (int column = -lamp_width; column < lamp_width; ++column) {
            const double up = (elevation_degrees + row + 0.5) * pi / 180, aside = (column + 0.5) * pi / 180;
            if (std::atan2(std::sin(up), std::cos(up) * std::cos(aside)) < least) continue;
            sum += 10 * std::sin(up) * std::cos(up) * std::pow(pi / 180, 2);
        }
    return sum / pi;
}

/// A floor, and a block as high as told beyond a wall.
struct BlockOnFloor {
    Vec3 floor{31.7, 31.9, 20.3};
    double wall = 42, high = 10;

    Volume volume() const {
        return volume_of([&](Vec3 p) {
            const double block = std::max(wall - p.x, p.z - floor.z - high);
            return logistic(std::min(p.z - floor.z, block), 0.8);
        });
    }
};

}  // namespace

TEST(LiveGeometry, APlateShadowsTheFloor) {
    for (const double edge : {0.4, 0.8})
        for (const double thick : {2.0, 3.0, 5.0})
            for (const double gap : {2.0, 3.0, 4.0, 6.0, 10.0})
                expect_near(under_plate(edge, thick, gap), 0.05, fmt::format("plate {} {} {}", edge, thick, gap));
}

TEST(LiveGeometry, ASlotIsDarkAtItsBottom) {
    for (const double edge : {0.4, 0.8})
        for (const double wide : {2.0, 4.0, 8.0})
            expect_near(bottom_of_slot(edge, wide), 0.07, fmt::format("slot {} {}", edge, wide));
}

TEST(LiveGeometry, ALayerShadesTheFloor) {
    for (const double edge : {0.4, 0.8})
        for (const double opacity : {0.3, 0.6})
            for (const double gap : {2.0, 4.0, 8.0})
                expect_near(under_layer(edge, opacity, gap), gap < 3 ? 0.3 : 0.05,
                            fmt::format("layer {} {} {}", edge, opacity, gap), skin(0, 200));
}

/// Of the voxels' values: what it changes of the light.
TEST(LiveGeometry, NoiseChangesLittle) {
    const auto check = [](const auto& scene, double within, const std::string& what) {
        const double clean = found_by_visibility(scene(0.0));
        for (const double range : {0.02, 0.05}) {
            const double noisy = found_by_visibility(scene(range * 200));
            if (std::getenv("CHIARO_SHOW"))
                fmt::print("{} noise of {} %: {:.3f} of {:.3f}\n", what, 100 * range, noisy, clean);
            EXPECT_NEAR(noisy, clean, within) << what << range;
        }
    };
    for (const double edge : {0.4, 0.8, 1.5}) {
        const auto noisy_ball = [&](double noise) {
            return SharpScene{ball(edge, 22.37, {1, 1, 1}, noise), at_ball(22.37), 1};
        };
        check(noisy_ball, 0.015, fmt::format("ball {}", edge));
        check([&](double noise) { return under_plate(edge, 3, 4, noise); }, 0.015, fmt::format("plate {}", edge));
        check([&](double noise) { return bottom_of_slot(edge, 8, noise); }, 0.015, fmt::format("slot {}", edge));
    }
}

TEST(LiveGeometry, AWedgeIsDarkestAtItsCrease) {
    constexpr double low = 1, high = 13;
    for (const double edge : {0.4, 0.8, 1.5})
        for (const double degrees : {60.0, 90.0, 140.0}) {
            const Wedge wedge(degrees);
            const Look look{centre + 1.2 * wedge.n1 + (low + high) / 2 * wedge.along, wedge.n1, wedge.along,
                            (high - low) / 2};
            const auto columns =
                irradiance_of_columns(shown(wedge.volume(edge, 0), look, {.method = Method::visibility}));
            const double missing = degrees < 90 ? 0.32 : degrees < 140 ? 0.1 : 0.04;
            for (const auto& [from, to] : {std::pair{0, 2}, {2, 6}, {6, 24}}) {
                double light = 0, truth = 0;
                for (int x = from; x < to; ++x) {
                    light += columns[std::size_t(x)];
                    truth += wedge.truth(low + (x + 0.5) / look.pixels * (high - low));
                }
                if (std::getenv("CHIARO_SHOW"))
                    fmt::print("wedge {} {}: {:+.1f} %\n", edge, degrees, 100 * (light / truth - 1));
                EXPECT_NEAR(light / truth, 1, missing) << edge << " " << degrees << " " << from;
            }
        }
}

/// Not where it would fall on what lies as high as light is read off the floor.
TEST(LiveGeometry, ASunsShadowEndsWhereItsRayDoes) {
    const BlockOnFloor scene;
    const auto& [floor, wall, high] = scene;
    const Volume volume = scene.volume();
    for (const double elevation : {35.0, 50.0}) {
        const double end = wall - high / std::tan(elevation * pi / 180);
        const Look look{{end, floor.y, floor.z + 4}, {0, 0, 1}, {1, 0, 0}, 6};
        for (const auto& [method, name] :
             {std::pair{Method::visibility, "visibility"}, {Method::transport, "transport"}}) {
            const auto columns =
                irradiance_of_columns(shown(volume, look, {.method = method}, skin(), sun_at(elevation)));
            const double half = (columns.front() + columns.back()) / 2;
            EXPECT_LT(columns.back(), 0.4 * columns.front());
            std::size_t x = 1;
            while (x + 1 < columns.size() && columns[x] > half) ++x;
            const double crossing = double(x) - 0.5 + (columns[x - 1] - half) / (columns[x - 1] - columns[x]),
                         found = end + (2 * crossing / look.pixels - 1) * look.half_width;
            if (std::getenv("CHIARO_SHOW"))
                fmt::print("{}, sun at {}: a shadow ends at {:.2f} of {:.2f}; light {:.2f} and {:.2f}\n", name,
                           elevation, found, end, columns.front(), columns.back());
            EXPECT_NEAR(found, end, 0.8) << name << " " << elevation;
        }
    }
}

/// As wide as what is seen of the lamp over the edge. By sixteen harmonics alone 12 to 18 % of the light is missing or
/// too much.
TEST(LiveGeometry, ALampsShadowIsAsSoftAsTheLamp) {
    const BlockOnFloor scene;
    const auto& [floor, wall, high] = scene;
    const Look look{{30, floor.y, floor.z + 4}, {0, 0, 1}, {1, 0, 0}, 9};
    for (const int elevation : {35, 50})
        for (const auto& [method, name] :
             {std::pair{Method::visibility, "visibility"}, {Method::transport, "transport"}}) {
            const auto columns = irradiance_of_columns(shown(
                scene.volume(), look, {.method = method, .scattering = {.bounces = {0}}}, skin(), lamp_at(elevation)));
            double square = 0, worst = 0;
            const double open = light_of_lamp(elevation, 0);
            for (std::size_t i = 0; i < columns.size(); ++i) {
                const double x = look.above.x + ((double(i) + 0.5) / look.pixels * 2 - 1) * look.half_width;
                const double missing = columns[i] - light_of_lamp(elevation, std::atan2(high, wall - x));
                square += missing * missing, worst = std::max(worst, std::abs(missing));
            }
            const double rms = std::sqrt(square / double(columns.size()));
            if (std::getenv("CHIARO_SHOW"))
                fmt::print("{}, lamp at {}: RMS {:.1f} %, worst {:.1f} % of {:.3f}\n", name, elevation,
                           100 * rms / open, 100 * worst / open, open);
            EXPECT_LT(rms, (method == Method::visibility ? 0.08 : 0.05) * open) << name << elevation;
        }
}

// Light at surfaces by visibility against sharp geometry, under white light; that of the reference: surfaces_test.cpp.
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

// Transport as it is seen: what is looked up between nodes, surfaces, and the conventions shared with the reference.
#include <chiaro/comparison.h>
#include <chiaro/samples.h>

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures.h"
#include "illumination/probe/reflection_table.h"
#include "illumination/transport/light.h"

using namespace chiaro;
using chiaro::testing::sampled;
using chiaro::testing::Shot;
using chiaro::testing::tested_device;

namespace {

/// A row of nodes, one to a voxel, lit from everywhere alike.
TransportNodes row_of_nodes(const std::vector<float>& light, const std::vector<float>& weight) {
    TransportNodes nodes;
    nodes.grid.count = {int(light.size()), 1, 1};
    for (float j : light) nodes.light.insert(nodes.light.end(), {j, j / 2, j / 4});
    nodes.weight = weight;
    nodes.moment.assign(9 * light.size(), 0);
    return nodes;
}

kernel::Vec3<float> light_at(const ShownLight& shown, float x, float solid = 0) {
    const kernel::ScatteredLight scattered{.on = true, .boundary_cells = shown.boundary_view};
    kernel::SamplePoint<float> sample{{x, 0, 0}, 0};
    sample.solid = solid;
    return scattered.incident<float>(shown.view, sample);
}

Frame image(const Volume& volume, const Shot& shot, const TransportSettings& settings = {.grid = 40}) {
    return shot.lit(volume, {.method = Method::transport, .transport = settings});
}

/// Opaque below z = 20, seen from above.
Volume open_surface() {
    return sampled<std::uint8_t>({40, 40, 40}, [](double, double, double z) { return z < 20 ? 200 : 0; });
}
Shot from_above() {
    Shot shot;
    shot.tf.points = {{99, {0.8, 0.5, 0.25}, 0}, {101, {0.8, 0.5, 0.25}, 1}};
    shot.camera.elevation_deg = 90;
    shot.camera.zoom = 4;
    return shot;
}
std::array<float, 3> centre(const Frame& frame) {
    const float* pixel = &frame.rgba[4 * (std::size_t(frame.height / 2) * frame.width + frame.width / 2)];
    return {pixel[0], pixel[1], pixel[2]};
}

/// Root of the mean square over pixels and channels of a - factor × b, over that of a.
double relative_difference(const Frame& a, const Frame& b, double factor = 1) {
    double squares = 0, all = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        squares += std::pow(a.rgba[i] - factor * b.rgba[i], 2);
        all += std::pow(a.rgba[i], 2);
    }
    return std::sqrt(squares / all);
}

}  // namespace

/// Bright air beside matter that is 10^4 times as dense shows only where there is nothing but air.
TEST(TransportImage, NodesWeighAsTheirMatter) {
    for (const float thin : {1e-4f, 0.02f, 1.0f}) {
        const std::vector<float> light{1, 0.01f, 0.02f, 4}, weight{thin, 1, thin, thin};
        const TransportLight nodes(tested_device(), row_of_nodes(light, weight), 1, {9, 9, 9});
        const auto shown = nodes.shown(Look::particles);
        for (float x = 0; x <= 3; x += 0.0625f) {
            const int i = std::min(int(x), 2);
            const double t = x - i, near = (1 - t) * weight[i], far = t * weight[i + 1];
            const double expected = (near * light[i] + far * light[i + 1]) / (near + far);
            const auto j = light_at(*shown, x);
            EXPECT_NEAR(j.x, expected, 1.5e-3 * expected) << thin << ' ' << x;
            EXPECT_NEAR(j.y, expected / 2, 1.5e-3 * expected / 2);
            EXPECT_NEAR(j.z, expected / 4, 1.5e-3 * expected / 4);
        }
    }
}

/// A cell that matter fills in part, beside opaque ones: thin samples read its own light, solid ones what a half space
/// answers to the light before it, others what lies between.
TEST(TransportImage, SolidSamplesReadTheLightOfSurfaces) {
    TransportNodes nodes = row_of_nodes({0.4f, 0.4f, 0.1f, 0.6f, 0.6f}, {1, 1, 0.5f, 1e-6f, 1e-6f});
    nodes.result.assign(15, 0);
    for (int c = 0; c < 3; ++c) nodes.result[3 + c] = 0.42f;
    const TransportLight light(tested_device(), std::move(nodes), 1, {9, 9, 9});
    const auto shown = light.shown(Look::particles);
    const float thin = light_at(*shown, 2).x, solid = light_at(*shown, 2, 1).x;
    EXPECT_NEAR(thin, 0.1, 1e-4);
    EXPECT_NEAR(solid, 0.42 * 0.475, 2e-3);  // .5² of its own light, the rest of the air's: .1 / 4 + 3 × .6 / 4
    EXPECT_NEAR(light_at(*shown, 2, 0.25f).x, thin + 0.25f * (solid - thin), 1e-5);
}

/// Radiance of two colours, above and below a horizon: on a surface that faces up, that above it.
TEST(TransportImage, SurfacesAreLitByWhatLiesAboveTheirHorizon) {
    const float above[3] = {0.6f, 0.2f, 0}, below[3] = {0.1f, 0.5f, 0.3f};
    for (const float horizon : {0.0f, -0.3f, -0.7f}) {
        TransportNodes nodes = row_of_nodes({1, 1, 1, 1}, {1, 1, 1e-6f, 1e-6f});
        nodes.scattered.assign(48, 0);
        for (int node = 2; node < 4; ++node)  // of the others nothing may be seen
            for (int c = 0; c < 3; ++c) {
                nodes.scattered[12 * node + c] = ((1 - horizon) * above[c] + (1 + horizon) * below[c]) / 2;
                nodes.scattered[12 * node + 3 + c] = (above[c] - below[c]) * (1 - horizon * horizon) / 4;
            }
        for (int i = 0; i < 24; ++i) nodes.scattered[i] = 0.9f;
        const TransportLight light(tested_device(), std::move(nodes), 1, {9, 9, 9});
        const auto shown = light.shown(Look::surfaces);
        const kernel::ScatteredLight scattered{.around = shown->around.data()};
        for (const float t : {0.25f, 0.5f, 1.0f}) {
            float e[3] = {0, 0, 0};
            scattered.add_to<kernel::NumbersOf<float>::Sixteen>(e, {1, 2, 1, 2, 1, 2, 1, 2},
                                                                {1 - t, t, 0, 0, 0, 0, 0, 0}, {1, 0, 0}, horizon);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c], above[c], 1e-2) << horizon << ' ' << t << ' ' << c;
        }
    }
}

/// Opaque cells that an earlier light found are taken over where matter is the same, and nowhere else.
TEST(TransportImage, KeptSurfacesAreThoseOfTheSameMatter) {
    const std::vector<float> dark{0.01f, 0.02f, 0.1f, 0.1f}, bright{0.3f, 0.2f, 0.6f, 0.8f};
    const auto lit = [](const std::vector<float>& light, const std::vector<float>& weight) {
        TransportNodes nodes = row_of_nodes(light, weight);
        for (const float w : weight) nodes.result.insert(nodes.result.end(), 3, w == 1 ? 0.42f : 0);
        return nodes;
    };
    const TransportLight before(tested_device(), lit(dark, {1, 1, 1e-3f, 1e-3f}), 1, {9, 9, 9});
    before.shown(Look::particles);
    for (const std::vector<float>& weight :
         {std::vector{1.0f, 1.0f, 1e-3f, 1e-3f}, std::vector{1.0f, 1e-3f, 1e-3f, 1.0f}}) {
        const TransportLight warm(tested_device(), lit(bright, weight), 1, {9, 9, 9}, &before);
        const TransportLight cold(tested_device(), lit(bright, weight), 1, {9, 9, 9});
        const auto a = warm.shown(Look::particles), b = cold.shown(Look::particles);
        for (float x = 0; x <= 3; x += 0.25f) EXPECT_EQ(light_at(*a, x).x, light_at(*b, x).x) << x;
    }
}

TEST(TransportImage, AnOpenFlatSurfaceKeepsItsBrightness) {
    const Volume volume = open_surface();
    Shot shot = from_above();
    for (const Mode mode : {Mode::dvr, Mode::iso})
        for (const int grid : {40, 16})
            for (const Shading shading : {Shading::none, Shading::lambert, Shading::phong}) {
                shot.shape.mode = mode;
                if (mode == Mode::iso) shot.shape.iso = {{.value = 100, .color = Rgb{0.8, 0.5, 0.25}}};
                shot.lighting.shading = Shading::none;
                const auto colors = centre(shot.lit(volume, {}));
                shot.lighting.shading = shading;
                const auto lit = centre(image(volume, shot, {.grid = grid, .first_directions = 100, .error = 0.02}));
                // What a highlight reflects of light from all around, seen from straight above, has no colour.
                const ReflectionTable highlight(shading == Shading::phong ? shot.lighting.specular : 0,
                                                shot.lighting.shininess);
                const float reflected = highlight.reflected().back();
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(lit[c] / ((1 - reflected) * colors[c] + reflected), 1, 0.02)
                        << to_text(mode) << grid << to_text(shading);
            }
}

TEST(TransportImage, ExposureAndStrengthAreFactors) {
    const Volume volume = make_sample("tubes", 24);
    Shot shot;
    shot.tf = sample_transfer_function("tubes");
    IlluminationSettings settings{.method = Method::transport, .transport = {.grid = 24}};
    settings.scattering.albedo_max = 1;
    const Frame full = shot.lit(volume, settings);
    shot.lighting.probe.exposure = 1.5;
    EXPECT_LT(relative_difference(shot.lit(volume, settings), full, std::exp2(1.5)), 1e-6);
    shot.lighting.probe.exposure = 0;
    shot.lighting.strength = 0;  // a white probe's light as if nothing stopped it
    const Frame clear = shot.lit(volume, settings);
    EXPECT_LT(relative_difference(clear, shot.lit(volume, {})), 5e-4);  // by a table over normals
    shot.lighting.strength = 0.25;
    const Frame quarter = shot.lit(volume, settings);
    for (std::size_t i = 0; i < full.rgba.size(); ++i)
        EXPECT_NEAR(quarter.rgba[i], 0.25 * full.rgba[i] + 0.75 * clear.rgba[i], 1e-5);
}

/// Colours are albedos where light may come by more than once: at most albedo-max, the others in proportion.
TEST(TransportImage, ColoursAreCappedAsTheReferenceHasThem) {
    const Volume volume = open_surface();
    Shot shot = from_above();
    shot.tf.points = {{99, {1, 0.5, 0}, 0}, {101, {1, 0.5, 0}, 1}};
    IlluminationSettings settings{.method = Method::transport, .transport = {.grid = 20}};
    settings.scattering.bounces.most = 0;
    const auto colors = centre(shot.lit(volume, {})), once = centre(shot.lit(volume, settings));
    settings.scattering = {.albedo_max = 0.5};
    const auto capped = centre(shot.lit(volume, settings));
    for (int c = 0; c < 2; ++c) {
        EXPECT_NEAR(once[c], colors[c], 0.02 * colors[c]);
        EXPECT_NEAR(capped[c], 0.5 * colors[c], 0.02 * colors[c]);
    }
}

/// The same for any number of threads and all instruction sets, as all pictures are.
TEST(TransportImage, IsTheSameOnAllMachines) {
    const Volume volume = make_sample("cornell", 24);
    Shot shot;
    shot.tf = sample_transfer_function("cornell");
    shot.lighting.shading = Shading::phong;
    const TransportSettings settings{.grid = 16, .first_directions = 50};
    const Frame first = image(volume, shot, settings);
    for (const int threads : {1, 3}) {
        shot.device.threads = threads;
        EXPECT_EQ(image(volume, shot, settings).rgba, first.rgba) << threads;
    }
    for (const Isa isa : available_isas()) {
        shot.device.isa = isa;
        EXPECT_EQ(image(volume, shot, settings).rgba, first.rgba) << to_text(isa);
    }
}

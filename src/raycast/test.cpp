// Truths of the ray caster: closed forms, convergence, symmetries, and equality over instruction sets and threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Length in mm of the pixel's ray inside the box of the voxel centres, by slabs in double precision.
double chord_mm(const Camera& camera, const Geometry& g, std::array<int, 3> n, int width, int height, int column,
                int row) {
    const double px = ((column + 0.5) / width * 2 - 1) * camera.half_height * width / height,
                 py = (1 - (row + 0.5) / height * 2) * camera.half_height;
    const Vec3 offset = px * camera.right + py * camera.up;
    const bool orthographic = camera.projection == Projection::orthographic;
    const Vec3 origin = g.voxel_from_world(orthographic ? camera.eye + offset : camera.eye);
    const Vec3 direction =
        g.voxel_from_world_vector(orthographic ? camera.forward : normalized(camera.forward + offset));
    double near = 0, far = 1e300;
    for (int a = 0; a < 3; ++a) {
        const double low = n[a] == 1 ? -0.5 : 0, high = n[a] == 1 ? 0.5 : n[a] - 1;
        const double p = (low - origin[a]) / direction[a], q = (high - origin[a]) / direction[a];
        near = std::fmax(near, std::fmin(p, q));
        far = std::fmin(far, std::fmax(p, q));
    }
    return std::fmax(0, far - near);
}

struct SlabCase {
    const char* name;
    std::array<int, 3> n;
    Vec3 spacing;
    CameraSettings camera;
    double step;
};

void PrintTo(const SlabCase& c, std::ostream* out) { *out << c.name; }

class HomogeneousSlab : public ::testing::TestWithParam<SlabCase> {};

}  // namespace

// T = exp(-κ L): at any step, oblique, from inside, with spacing, for every instruction set.
TEST_P(HomogeneousSlab, TransmittanceIsExponential) {
    const SlabCase& c = GetParam();
    Volume volume = sampled<std::uint8_t>(c.n, [](double, double, double) { return 100; });
    volume.geometry.spacing_mm = c.spacing;
    Shot shot;
    shot.tf = constant(0.03);
    shot.tf.opacity_unit_is_mm = true;
    const double kappa = -std::log1p(-0.03);
    shot.camera = c.camera;
    shot.rays.step_voxels = c.step;
    const Camera camera = make_camera(c.camera, volume.geometry, volume.dimensions);
    for (Isa isa : available_isas()) {
        shot.device.isa = isa;
        const Frame frame = shot(volume);
        int hit = 0;
        for (int row = 0; row < frame.height; ++row)
            for (int column = 0; column < frame.width; ++column) {
                const double length_mm = chord_mm(camera, volume.geometry, c.n, frame.width, frame.height, column, row);
                const float* pixel = &frame.rgba[4 * (std::size_t(row) * frame.width + column)];
                ASSERT_NEAR(pixel[3], -std::expm1(-kappa * length_mm), 2e-4)
                    << name_of(isa) << " pixel " << column << "," << row;
                ASSERT_NEAR(pixel[0], pixel[3], 1e-5);
                hit += length_mm > 0;
            }
        EXPECT_GT(hit, 500);
    }
}

INSTANTIATE_TEST_SUITE_P(
    GroundTruth, HomogeneousSlab,
    ::testing::Values(
        SlabCase{"oblique", {40, 40, 40}, {1, 1, 1}, {}, 0.5}, SlabCase{"coarse", {40, 40, 40}, {1, 1, 1}, {}, 3.7},
        SlabCase{"fine", {40, 40, 40}, {1, 1, 1}, {}, 0.13},
        SlabCase{"spacing", {20, 40, 70}, {2, 0.9, 0.5}, {.azimuth_deg = -70, .elevation_deg = 50}, 1},
        SlabCase{"axis",
                 {40, 30, 33},
                 {1, 1, 1},
                 {.azimuth_deg = 0, .elevation_deg = 0, .projection = Projection::orthographic},
                 0.7},
        SlabCase{"above", {40, 30, 33}, {1, 1, 1}, {.elevation_deg = 90, .projection = Projection::orthographic}, 0.7},
        SlabCase{"inside", {40, 40, 40}, {1, 1, 1}, {.eye = Vec3{10, 12, 20}, .target = Vec3{30, 25, 11}}, 0.5},
        SlabCase{"one_slice", {40, 40, 1}, {1, 1, 3}, {.elevation_deg = 60}, 0.5}),
    [](const auto& test) { return std::string(test.param.name); });

// The midpoint rule is of second order: halving the step quarters the error of ∫ κ dt for a quadratic κ.
TEST(RayCaster, QuadraticExtinctionConvergesWithTheSquareOfTheStep) {
    const Volume volume = sampled<float>({33, 9, 9}, [](double x, double, double) { return x; });
    Shot shot;
    shot.tf.points.clear();
    shot.tf.rgb_space = RgbSpace::linear;
    const double strength = 0.05, exact = strength * 32 / 3;
    for (int i = 0; i <= 3200; ++i) {
        const double x = i / 100.0, kappa = strength * (x / 32) * (x / 32);
        shot.tf.points.push_back({x, {1, 1, 1}, -std::expm1(-kappa)});
    }
    shot.camera = {.azimuth_deg = 0, .elevation_deg = 0, .projection = Projection::orthographic};
    const auto error = [&](double step) {
        shot.rays.step_voxels = step;
        const Frame frame = shot(volume);
        return std::abs(-std::log1p(-frame.rgba[4 * (23 * 61 + 30) + 3]) - exact);
    };
    const double e8 = error(8), e4 = error(4), e2 = error(2);
    EXPECT_NEAR(e8, strength / 6, 0.02 * strength);  // h²/24 (κ'(b) - κ'(a))
    EXPECT_NEAR(e8 / e4, 4, 0.1);
    EXPECT_NEAR(e4 / e2, 4, 0.3);
}

TEST(RayCaster, SkippingEmptySpaceChangesNoBit) {
    for (int azimuth : {0, 17, 90, 200}) {
        Shot shot;
        shot.camera.azimuth_deg = azimuth;
        shot.camera.elevation_deg = azimuth / 4.0;
        shot.lighting.shading = Shading::phong;
        const Volume volume =
            sampled<std::uint8_t>({70, 70, 70}, [](double x, double y, double z) { return shells(x, y, z, 70); });
        for (Isa isa : available_isas()) {
            shot.device.isa = isa;
            shot.rays.skip_empty = true;
            const Frame skipped = shot(volume);
            shot.rays.skip_empty = false;
            const Frame all = shot(volume);
            EXPECT_GT(mean_alpha(all), 0.05);
            EXPECT_EQ(std::memcmp(skipped.rgba.data(), all.rgba.data(), all.rgba.size() * sizeof(float)), 0)
                << name_of(isa) << " azimuth " << azimuth;
        }
    }
}

TEST(RayCaster, SkippingTakesFewerSamples) {
    const Device device = tested_device();
    const DeviceVolume volume = upload(
        device, sampled<std::uint8_t>({96, 96, 96}, [](double x, double y, double z) { return shells(x, y, z, 96); }));
    const Medium medium = classify(volume, two_materials(), {});
    Progress progress;
    Frame frame(64, 64);
    const auto samples = [&](bool skip) {
        return raycast(device, medium, IlluminationField(), {}, make_camera({}, volume.geometry(), volume.dimensions()),
                       {.early_termination = 0, .skip_empty = skip}, frame, progress)
            .samples;
    };
    EXPECT_LT(samples(true), samples(false) / 2);
    EXPECT_GT(samples(true), 0u);
}

TEST(RayCaster, ThreadsChangeNoBit) {
    const Volume volume =
        sampled<std::uint16_t>({64, 50, 40}, [](double x, double y, double z) { return 200 * shells(x, y, z, 50); });
    Shot shot;
    for (auto& point : shot.tf.points) point.value *= 200;
    shot.lighting.shading = Shading::phong;
    shot.width = 200, shot.height = 150;
    shot.device.threads = 1;
    const Frame one = shot(volume);
    for (int threads : {2, 7}) {
        shot.device.threads = threads;
        EXPECT_EQ(std::memcmp(shot(volume).rgba.data(), one.rgba.data(), one.rgba.size() * sizeof(float)), 0)
            << threads;
    }
}

template <class T>
void expect_equal_over_instruction_sets(double scale) {
    const Volume volume =
        sampled<T>({60, 60, 60}, [&](double x, double y, double z) { return scale * shells(x, y, z, 60); });
    Shot shot;
    for (auto& point : shot.tf.points) point.value *= scale;
    shot.lighting.shading = Shading::phong;
    shot.rays.early_termination = 0.005;
    shot.width = 160, shot.height = 120;
    shot.device.isa = Isa::scalar;
    const Frame scalar = shot(volume);
    EXPECT_GT(mean_alpha(scalar), 0.05);
    for (Isa isa : available_isas()) {
        shot.device.isa = isa;
        EXPECT_EQ(std::memcmp(shot(volume).rgba.data(), scalar.rgba.data(), scalar.rgba.size() * sizeof(float)), 0)
            << name_of(isa);
    }
}
TEST(RayCaster, InstructionSetsAgreeForBytes) { expect_equal_over_instruction_sets<std::uint8_t>(1); }
TEST(RayCaster, InstructionSetsAgreeForShorts) { expect_equal_over_instruction_sets<std::uint16_t>(37); }
TEST(RayCaster, InstructionSetsAgreeForFloats) { expect_equal_over_instruction_sets<float>(0.01); }

// Turning the object, the camera and the light together changes nothing.
TEST(RayCaster, QuarterTurnsOfEverythingAreInvisible) {
    const auto body = [](double x, double y, double z) {
        return shells(x, y, z, 48) * (0.7 + 0.3 * std::sin(0.2 * x + 0.1 * y)) * (y > 20 ? 1 : 0.6);
    };
    Shot shot;
    shot.lighting = {.shading = Shading::phong,
                     .lights = {{.headlight = false, .azimuth_deg = 10, .elevation_deg = 40}}};
    const Volume still = sampled<float>({48, 48, 48}, body);
    const Frame before = shot(still);
    // The voxels turned a quarter about z: new x = -y, new y = x.
    const Volume turned =
        sampled<float>({48, 48, 48}, [&](double x, double y, double z) { return body(y, 47 - x, z); });
    shot.camera.azimuth_deg += 90;
    shot.lighting.lights[0].azimuth_deg += 90;
    EXPECT_LT(difference(shot(turned), before, 0).max, 2e-4);
    // The same through the geometry: the index axes turned in the world.
    Volume tilted = sampled<float>({48, 48, 48}, body);
    tilted.geometry.direction = {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}};
    EXPECT_LT(difference(shot(tilted), before, 0).max, 2e-4);
}

// One object stored with its axes in another order and sense, as its direction says, gives the same picture.
TEST(RayCaster, StorageOrderIsInvisible) {
    const auto body = [](double x, double y, double z) {
        return shells(x, y, z, 40) * (x > 15 ? 1 : 0.5) + (z > 30 && y < 12 ? 200 : 0);
    };
    Shot shot;
    shot.lighting.shading = Shading::phong;
    Volume plain = sampled<std::uint8_t>({40, 36, 44}, body);
    plain.geometry.spacing_mm = {1, 2, 1.5};
    const Frame expected = shot(plain);
    // index a runs along -z, b along x, c along y
    Volume other =
        sampled<std::uint8_t>({44, 40, 36}, [&](double a, double b, double c) { return body(b, c, 43 - a); });
    other.geometry.spacing_mm = {1.5, 1, 2};
    other.geometry.direction = {{{0, 0, -1}, {1, 0, 0}, {0, 1, 0}}};
    other.geometry.origin_mm = {0, 0, 43 * 1.5};
    EXPECT_LT(difference(shot(other), expected, 0).max,
              2e-3);  // steep edges: rounding moves a sample across a table entry
    EXPECT_LE(difference(shot(other), expected, 1e-4).pixels_beyond, 30);
}

TEST(RayCaster, MillimetresScale) {
    Volume volume =
        sampled<std::uint8_t>({40, 40, 40}, [](double x, double y, double z) { return shells(x, y, z, 40); });
    Shot shot;
    shot.lighting.shading = Shading::phong;
    const Frame expected = shot(volume);
    volume.geometry.spacing_mm = {0.01, 0.01, 0.01};
    volume.geometry.origin_mm = {5, -3, 2};
    EXPECT_LT(difference(shot(volume), expected, 0).max, 1e-3);
    EXPECT_LE(difference(shot(volume), expected, 1e-4).pixels_beyond, 30);
    shot.tf.opacity_unit_is_mm = true;
    shot.tf.opacity_unit = 0.01;
    EXPECT_LE(difference(shot(volume), expected, 1e-4).pixels_beyond, 30);
}

TEST(RayCaster, SmallerStepsConverge) {
    const Volume volume =
        sampled<float>({40, 40, 40}, [](double x, double y, double z) { return shells(x, y, z, 40); });
    Shot shot;
    shot.rays.step_voxels = 0.05;
    const Frame fine = shot(volume);
    double last = 1;
    for (double step : {1.0, 0.5, 0.25}) {
        shot.rays.step_voxels = step;
        const double worst = difference(shot(volume), fine, 0).max;
        EXPECT_LT(worst, last);
        last = worst;
    }
    EXPECT_LT(last, 0.02);
}

TEST(RayCaster, EarlyTerminationStaysWithinItsShare) {
    const Volume volume =
        sampled<std::uint8_t>({50, 50, 50}, [](double x, double y, double z) { return shells(x, y, z, 50); });
    Shot shot;
    const Frame whole = shot(volume);
    shot.rays.early_termination = 0.05;
    EXPECT_LE(difference(shot(volume), whole, 0).max, 0.05);
}

TEST(RayCaster, OneVoxelIsACubeOfItsSize) {
    Shot shot;
    shot.tf = constant(0.5);
    shot.camera = {.azimuth_deg = 0, .elevation_deg = 0, .projection = Projection::orthographic};
    const Frame frame = shot(sampled<std::uint8_t>({1, 1, 1}, [](double, double, double) { return 7; }));
    EXPECT_NEAR(frame.rgba[4 * (23 * 61 + 30) + 3], 0.5, 1e-4);
}

// A ramp has one normal everywhere: ambient + diffuse |n · l|, specular (n · h)^s times opacity.
TEST(Shading, OfARampIsItsClosedForm) {
    Volume ramp = sampled<float>({16, 16, 16}, [](double x, double y, double) { return x + y; });
    ramp.geometry.spacing_mm = {1, 2, 1};  // gradient (1, ½, 0) per mm
    Shot shot;
    shot.tf = constant(0.9999, {0.5, 0.5, 0.5});
    shot.tf.opacity_unit = 0.01;
    shot.shape.threshold_low = 0, shot.shape.threshold_high = 20;  // the border would be a cut
    shot.camera = {.azimuth_deg = 0, .elevation_deg = 0, .projection = Projection::orthographic};
    shot.lighting = {.shading = Shading::phong,
                     .ambient = 0.1,
                     .diffuse = 0.6,
                     .specular = 0.4,
                     .shininess = 8,
                     .lights = {{.headlight = false, .azimuth_deg = 60, .elevation_deg = 0, .color = {1, 0, 1}}}};
    const Frame frame = shot(ramp);
    const Vec3 normal = normalized({1, 0.5, 0}), light{0.5, std::sqrt(0.75), 0},
               half = normalized(light + Vec3{1, 0, 0});
    const double diffuse = 0.1 + 0.6 * dot(normal, light), highlight = 0.4 * std::pow(dot(normal, half), 8);
    const float* pixel = &frame.rgba[4 * (23 * 61 + 30)];
    EXPECT_NEAR(pixel[0], 0.5 * diffuse + highlight, 1e-3);
    EXPECT_NEAR(pixel[1], 0.5 * 0.1, 1e-3);  // no green in the light
    EXPECT_NEAR(pixel[3], 1, 1e-5);
}

TEST(RayCaster, CancelsBetweenTiles) {
    const Volume volume = sampled<std::uint8_t>({20, 20, 20}, [](double, double, double) { return 100; });
    const Device device = tested_device();
    const DeviceVolume on_device = upload(device, volume);
    Progress progress;
    progress.cancel();
    Frame frame(100, 100);
    const RenderStatistics render_statistics =
        raycast(device, classify(on_device, constant(0.5), {}), IlluminationField(), {},
                make_camera({}, on_device.geometry(), on_device.dimensions()), {}, frame, progress);
    EXPECT_FALSE(render_statistics.complete);
    EXPECT_EQ(render_statistics.samples, 0u);
}

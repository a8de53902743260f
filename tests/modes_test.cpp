// Isosurfaces, maxima and clipping: closed forms, and one body of tests over every mode.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "fixtures.h"
#include "raycast/views.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Answers the ray caster's question with the place it was asked for: a picture of positions.
struct PositionView {
    static constexpr bool modulates = true, adds_opacity = false, by_surface = false;
    template <class F>
    CHIARO_INLINE kernel::Incident<F> incident(const kernel::SamplePoint<F>& s, const kernel::ShadingView&) const {
        return {s.p_voxel, kernel::Vec3<F>(F(0), F(0), F(0))};
    }
};

/// Where each pixel's first surface lies, in voxels; alpha 0 where there is none.
Frame positions(const Volume& volume, const Shape& shape, const CameraSettings& settings, double step) {
    const Medium medium = classify(upload(tested_device(), volume), constant(1), shape);
    const RaySettings rays{.step_voxels = step, .early_termination = 0};
    const RayTables tables = make_tables(medium.data(), rays, 1);
    Frame frame(64, 64);
    const auto kernel =
        make_kernel<float>(medium.data(), tables, PositionView{}, {.shading = Shading::none},
                           make_camera(settings, volume.geometry, volume.dimensions), rays, frame, false);
    kernel::run_tile<float>(kernel, {0, 0, 64, 64});
    return frame;
}

struct View {
    const float* pixel;
    bool hit() const { return pixel[3] > 0; }
    Vec3 p() const { return {pixel[0], pixel[1], pixel[2]}; }
};

template <class Check>
int for_each_hit(const Frame& frame, Check&& check) {
    int hits = 0;
    for (std::size_t i = 0; i < frame.rgba.size(); i += 4)
        if (const View view{&frame.rgba[i]}; view.hit()) check(view.p()), ++hits;
    return hits;
}

Volume shells_volume(int n) {
    return sampled<std::uint8_t>({n, n, n}, [&](double x, double y, double z) { return shells(x, y, z, n); });
}

/// A camera that does not depend on the volume it looks at.
CameraSettings fixed_camera() { return {.eye = Vec3{80, 55, 60}, .target = Vec3{20, 20, 20}}; }

bool same_bits(const Frame& a, const Frame& b) {
    return std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)) == 0;
}

}  // namespace

// The distance field is not trilinear, so the ball is large: its curvature shifts the surface by 1/(8 R) at most.
TEST(Isosurface, HitsABallToAHundredthOfAVoxel) {
    const Volume volume = sampled<float>({81, 81, 81}, [](double x, double y, double z) {
        return 900 - (x - 40) * (x - 40) - (y - 40) * (y - 40) - (z - 40) * (z - 40);
    });
    for (double step : {1.0, 0.5}) {
        const Frame frame = positions(volume, {.mode = Mode::iso, .iso = {{.value = 0}}}, {}, step);
        const int hits = for_each_hit(frame, [&](Vec3 p) {
            // the trilinear surface of r² lies within the second differences (2 per axis, 1/4 each at most) of the
            // sphere
            EXPECT_NEAR(length(p - Vec3{40, 40, 40}), 30, 0.01 + 0.75 / 60);
        });
        EXPECT_GT(hits, 500);
    }
}

TEST(Isosurface, HitsAPlaneToAHundredthOfAVoxel) {
    const Volume volume =
        sampled<float>({40, 40, 40}, [](double x, double y, double z) { return 0.3 * x + 0.5 * y - 0.2 * z; });
    for (double step : {2.0, 1.0, 0.37}) {
        const Frame frame =
            positions(volume, {.mode = Mode::iso, .iso = {{.value = 10.123}}}, {.azimuth_deg = 70}, step);
        const int hits = for_each_hit(frame, [&](Vec3 p) {
            EXPECT_NEAR((0.3 * p.x + 0.5 * p.y - 0.2 * p.z - 10.123) / std::sqrt(0.38), 0, 0.01);
        });
        EXPECT_GT(hits, 300);
    }
}

// Two nested balls on the way in and out again: 1 - (1-a)² (1-b)².
TEST(Isosurface, SeveralCompositeInTheirOrder) {
    const Volume volume = sampled<float>({41, 41, 41}, [](double x, double y, double z) {
        return 20 - std::sqrt((x - 20) * (x - 20) + (y - 20) * (y - 20) + (z - 20) * (z - 20));
    });
    Shot shot;
    shot.shape = {.mode = Mode::iso, .iso = {{12, Rgb{0, 1, 0}, 0.3}, {5, Rgb{1, 0, 0}, 0.5}}};
    shot.camera = {.azimuth_deg = 0, .elevation_deg = 0, .projection = Projection::orthographic};
    for (double step : {0.5, 9.0}) {  // with the long step one sample lies behind both surfaces
        shot.rays.step_voxels = step;
        const Frame frame = shot(volume);
        const float* centre = &frame.rgba[4 * (23 * 61 + 30)];
        EXPECT_NEAR(centre[0], 0.5 + 0.5 * 0.7 * 0.7 * 0.5, 1e-5);
        EXPECT_NEAR(centre[1], 0.5 * (0.3 + 0.7 * 0.3), 1e-5);
        EXPECT_NEAR(centre[3], 1 - 0.5 * 0.7 * 0.7 * 0.5, 1e-5);
    }
}

namespace {

/// A function that is trilinear, so that interpolation is exact.
double saddle(double x, double y, double z) { return 20 + 1.5 * x - 0.8 * y + 0.9 * z + 0.05 * x * y - 0.06 * y * z; }

/// Linear in the value: red is (value + 100) / 300.
Shot of_values(Mode mode) {
    Shot shot;
    shot.shape.mode = mode;
    shot.tf.points = {{-100, {0, 0, 0}, 1}, {200, {1, 1, 1}, 1}};
    shot.tf.rgb_space = RgbSpace::linear;
    shot.rays.step_voxels = 0.7;
    return shot;
}

/// Of each pixel that shows so much of the box as a voxel: `check(red, t from, t to, value(t))`.
template <class Check>
void for_each_ray(const Shot& shot, const Volume& volume, Check&& check) {
    const Frame frame = shot(volume);
    const Camera camera = make_camera(shot.camera, volume.geometry, volume.dimensions);
    int hits = 0;
    for (int row = 0; row < frame.height; ++row)
        for (int column = 0; column < frame.width; ++column) {
            const double px = ((column + 0.5) / frame.width * 2 - 1) * camera.half_height * frame.width / frame.height;
            const double py = (1 - (row + 0.5) / frame.height * 2) * camera.half_height;
            const Vec3 d = normalized(camera.forward + px * camera.right + py * camera.up);
            double near = 0, far = 1e9;
            for (int a = 0; a < 3; ++a) {
                const double p = (0 - camera.eye[a]) / d[a], q = (39 - camera.eye[a]) / d[a];
                near = std::max(near, std::min(p, q)), far = std::min(far, std::max(p, q));
            }
            if (far - near < 1) continue;  // corners, where rounding decides on the number of samples
            check(&frame.rgba[4 * std::size_t(row * frame.width + column)], near, far,
                  [&](double t) { return camera.eye + t * d; });
            ++hits;
        }
    EXPECT_GT(hits, 300);
}

}  // namespace

TEST(ValueOfARay, IsTheLargestSmallestOrMeanOfTheSamples) {
    const Volume volume = sampled<float>({40, 40, 40}, saddle);
    for (const Mode mode : {Mode::mip, Mode::minip, Mode::mean})
        for_each_ray(of_values(mode), volume, [&](const float* pixel, double near, double far, const auto& at) {
            double most = -1e9, least = 1e9, sum = 0;
            for (double t = near; t < far; t += 0.7) {
                const double step = std::min(0.7, far - t);
                const Vec3 p = at(t + step / 2);
                const double value = saddle(p.x, p.y, p.z);
                most = std::max(most, value), least = std::min(least, value), sum += step * value;
            }
            const double expected = mode == Mode::mip ? most : mode == Mode::minip ? least : sum / (far - near);
            ASSERT_NEAR(pixel[0], (expected + 100) / 300, 1e-3) << to_text(mode);
        });
}

// Where the file turns values round (slope -1) the largest stored number is the smallest value.
TEST(ValueOfARay, IsOfValuesNotOfStoredNumbers) {
    Volume volume = sampled<float>({40, 40, 40}, [](double x, double y, double z) { return -saddle(x, y, z); });
    volume.slope = -1;
    const Volume plain = sampled<float>({40, 40, 40}, saddle);
    for (const Mode mode : {Mode::mip, Mode::minip, Mode::mean})
        EXPECT_LT(difference(of_values(mode)(volume), of_values(mode)(plain), 0).max, 1e-3) << to_text(mode);
}

TEST(ValueOfARay, SkippingChangesNoBitNorDoInstructionSets) {
    const Volume volume = shells_volume(48);
    for (const Mode mode : {Mode::mip, Mode::minip, Mode::mean, Mode::additive}) {
        Shot shot;
        shot.shape.mode = mode;
        shot.rays.skip_empty = false;
        shot.device.isa = Isa::scalar;
        const Frame all = shot(volume);
        shot.rays.skip_empty = true;
        for (Isa isa : available_isas()) {
            shot.device.isa = isa;
            EXPECT_TRUE(same_bits(shot(volume), all)) << to_text(mode) << " " << name_of(isa);
        }
    }
}

// ∫ κ c ds of a constant medium is κ c L, whatever the step and the order; its opacity is κ L, 1 at most.
TEST(Additive, OfAConstantMediumIsItsLength) {
    const Volume volume = sampled<float>({40, 40, 40}, [](double, double, double) { return 100; });
    for (const double step : {0.5, 2.3})
        for (const auto order : {Compositing::front_to_back, Compositing::back_to_front}) {
            Shot shot;
            shot.shape.mode = Mode::additive;
            shot.tf = constant(0.03, {0.5, 1, 0.25});
            shot.rays.step_voxels = step, shot.rays.compositing = order;
            shot.lighting.shading = Shading::phong;  // what is emitted is not shaded
            const double kappa = -std::log1p(-0.03);
            for_each_ray(shot, volume, [&](const float* pixel, double near, double far, const auto&) {
                const double sum = kappa * (far - near);
                ASSERT_NEAR(pixel[0], 0.5 * sum, 1e-3);
                ASSERT_NEAR(pixel[1], sum, 1e-3);
                ASSERT_NEAR(pixel[3], std::min(sum, 1.0), 1e-3);
            });
        }
}

// Nothing hides anything: two things one behind the other are the sum of each alone.
TEST(Additive, IsTheSumOfItsParts) {
    const auto ball = [](double x, double y, double z, double at) {
        return std::max(0.0, 100 - 10 * std::hypot(x - at, y - 20, z - 20));
    };
    Shot shot;
    shot.shape.mode = Mode::additive;
    shot.tf.points = {{0, {1, 0.5, 0.2}, 0}, {100, {1, 0.5, 0.2}, 0.2}};
    shot.tf.rgb_space = RgbSpace::linear;
    shot.camera = {.azimuth_deg = 0, .elevation_deg = 0};
    const auto of = [&](bool first, bool second) {
        return shot(sampled<float>({41, 41, 41}, [&](double x, double y, double z) {
            return (first ? ball(x, y, z, 10) : 0) + (second ? ball(x, y, z, 30) : 0);
        }));
    };
    const Frame one = of(true, false), other = of(false, true), both = of(true, true);
    for (std::size_t i = 0; i < both.rgba.size(); ++i)
        if (i % 4 != 3) ASSERT_NEAR(both.rgba[i], one.rgba[i] + other.rgba[i], 1e-4 * (1 + both.rgba[i]));
    EXPECT_GT(mean_alpha(both), 0.01);
}

// Planes through voxel centres leave exactly what a cropped file holds.
TEST(Clipping, EqualsTheCroppedVolume) {
    const Volume whole = shells_volume(40);
    Volume cropped =
        sampled<std::uint8_t>({22, 30, 40}, [](double x, double y, double z) { return shells(x + 8, y, z, 40); });
    cropped.geometry.origin_mm = {8, 0, 0};
    Shot shot;
    shot.camera = fixed_camera();
    for (Mode mode : {Mode::dvr, Mode::iso, Mode::mip}) {
        shot.shape = {.mode = mode, .iso = {{.value = 100, .opacity = 0.5}}};
        const Frame expected = shot(cropped);
        EXPECT_GT(mean_alpha(expected), 0.02);
        if (mode == Mode::iso) continue;  // an isosurface is closed by the cut: the next test
        shot.shape.clip.box = {8 / 39.0, 29 / 39.0, 0, 29 / 39.0, 0, 1};
        EXPECT_LE(difference(shot(whole), expected, 1e-3).pixels_beyond, 3);
        shot.shape.clip = {.planes = {{{-2, 0, 0}, -16}, {{1, 0, 0}, 29}, {{0, 3, 0}, 87}}};
        EXPECT_LE(difference(shot(whole), expected, 1e-3).pixels_beyond, 3);
    }
}

// Through solid matter a cut shows the plane's normal, whatever the gradient behind it.
TEST(Clipping, CutFacesHaveThePlanesNormal) {
    const Volume volume = sampled<std::uint8_t>(
        {40, 40, 40}, [](double x, double y, double z) { return 150 + 40 * std::sin(x) * std::sin(y + z); });
    const Vec3 normal = normalized({1, 0.3, 0.5});
    Shot shot;
    shot.tf = constant(0.999, {0.5, 0.5, 0.5});
    shot.camera = {.azimuth_deg = 10, .elevation_deg = 20, .projection = Projection::orthographic};
    shot.lighting = {.shading = Shading::lambert, .ambient = 0.1, .diffuse = 0.8};
    const Vec3 to_light = orbit_direction(10 * M_PI / 180, 20 * M_PI / 180, {0, 0, 1});
    shot.rays.step_voxels = 1;
    for (Mode mode : {Mode::dvr, Mode::iso}) {
        shot.shape = {.mode = mode, .iso = {{.value = 80, .color = Rgb{1, 1, 1}}}};
        shot.shape.clip.planes = {{normal, dot(normal, {20, 20, 20})}};
        const Frame frame = shot(volume);
        const float* centre = &frame.rgba[4 * (23 * 61 + 30)];
        EXPECT_NEAR(centre[0], (mode == Mode::dvr ? 0.5 : 1) * (0.1 + 0.8 * dot(normal, to_light)), 2e-3) << int(mode);
        EXPECT_GT(centre[3], 0.99);
    }
}

TEST(Clipping, RefusesWhatShowsNothing) {
    const DeviceVolume volume = upload(tested_device(), shells_volume(8));
    EXPECT_THROW(classify(volume, two_materials(), {.clip = {.box = std::array{0.5, 0.5, 0.0, 1.0, 0.0, 1.0}}}), Error);
    EXPECT_THROW(classify(volume, two_materials(), {.clip = {.planes = std::vector<ClipPlane>(7)}}), Error);
    EXPECT_THROW(classify(volume, two_materials(), {.mode = Mode::iso}), Error);
    EXPECT_THROW(classify(volume, two_materials(), {.mode = Mode::iso, .iso = std::vector<IsoSurface>(9)}), Error);
}

// One body over all: mode, camera, clip, classification, order, voxel type, instruction set; skipping and threads
// change no bit.
template <class T>
class EveryMode : public ::testing::Test {};
using VoxelTypes = ::testing::Types<std::uint8_t, std::uint16_t, float>;
TYPED_TEST_SUITE(EveryMode, VoxelTypes);

namespace {

/// Every mode, with every classification that it knows, in both orders.
std::vector<std::pair<Mode, RaySettings>> ways() {
    const RaySettings plain{.step_voxels = 0.5, .early_termination = 0};
    std::vector<std::pair<Mode, RaySettings>> all;
    for (Compositing compositing : {Compositing::front_to_back, Compositing::back_to_front}) {
        RaySettings rays = plain;
        rays.compositing = compositing;
        all.insert(all.end(), {{Mode::iso, rays}, {Mode::mip, rays}});
        for (Classification c : {Classification::post, Classification::pre, Classification::preintegrated}) {
            rays.classification = c;
            all.emplace_back(Mode::dvr, rays);
        }
    }
    return all;
}

/// The same bits on every instruction set, with and without skipping, however rays are set up, on one thread and two.
void expect_same_everywhere(const DeviceVolume& volume, Shot shot) {
    shot.device = {1, Isa::scalar};
    shot.rays.skip_empty = false;
    const Frame expected = shot(volume);
    EXPECT_GT(mean_alpha(expected), 0.02);
    for (Isa isa : available_isas())
        for (bool skip : {true, false})
            for (RaySetup setup : {RaySetup::box, RaySetup::raster}) {
                shot.device = {2, isa};
                shot.rays.skip_empty = skip;
                shot.rays.ray_setup = setup;
                EXPECT_TRUE(same_bits(shot(volume), expected)) << name_of(isa) << " skip " << skip << to_text(setup);
            }
}

}  // namespace

TYPED_TEST(EveryMode, GivesTheSameBitsEverywhere) {
    Volume volume = sampled<TypeParam>({40, 36, 44}, [](double x, double y, double z) { return shells(x, y, z, 42); });
    volume.geometry.spacing_mm = {1, 1.2, 0.8};
    const DeviceVolume on_device = upload(tested_device(), volume);
    for (const auto& [mode, rays] : ways())
        for (Projection projection : {Projection::perspective, Projection::orthographic})
            for (bool clipped : {false, true}) {
                Shot shot;
                shot.lighting.shading = Shading::phong;
                shot.camera.projection = projection;
                shot.rays = rays;
                shot.rays.samples_per_pixel = clipped ? 3 : 1;
                shot.shape = {.mode = mode, .iso = {{.value = 90, .opacity = 0.6}, {.value = 150}}};
                if (clipped)
                    shot.shape.clip = {.box = std::array{0.1, 1.0, 0.0, 0.9, 0.2, 1.0}, .planes = {{{1, 1, 1}, 70}}};
                SCOPED_TRACE(to_text(mode) + " " + to_text(rays.classification) + " " + to_text(rays.compositing) +
                             (clipped ? " clipped" : ""));
                expect_same_everywhere(on_device, shot);
            }
}

TYPED_TEST(EveryMode, OfSplinesGivesTheSameBitsEverywhere) {
    const Volume volume =
        sampled<TypeParam>({40, 36, 44}, [](double x, double y, double z) { return shells(x, y, z, 42); });
    const DeviceVolume on_device = upload(tested_device(), volume);
    for (const auto& [mode, rays] : ways())
        for (const Interpolation interpolation : {Interpolation::cubic, Interpolation::smooth}) {
            Shot shot;
            shot.lighting.shading = Shading::phong;
            shot.rays = rays;
            shot.shape = {.mode = mode, .iso = {{.value = 90, .opacity = 0.6}, {.value = 150}}};
            const Frame linear = shot(on_device);
            shot.shape.interpolation = interpolation;
            SCOPED_TRACE(to_text(mode) + " " + to_text(rays.classification) + " " + to_text(interpolation));
            expect_same_everywhere(on_device, shot);
            const Difference found = difference(shot(on_device), linear, 0);
            if (rays.classification != Classification::pre || mode != Mode::dvr) EXPECT_GT(found.max, 0.01);
        }
}

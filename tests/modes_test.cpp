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

TEST(Maximum, IsThatOfTheSamples) {
    const auto f = [](double x, double y, double z) {
        return 20 + 1.5 * x - 0.8 * y + 0.9 * z + 0.05 * x * y - 0.06 * y * z;
    };
    const Volume volume = sampled<float>({40, 40, 40}, f);
    Shot shot;
    shot.shape.mode = Mode::mip;
    shot.tf.points = {{-100, {0, 0, 0}, 1}, {200, {1, 1, 1}, 1}};
    shot.tf.rgb_space = RgbSpace::linear;
    shot.rays.step_voxels = 0.7;
    const Frame frame = shot(volume);
    const Camera camera = make_camera(shot.camera, volume.geometry, volume.dimensions);
    int hits = 0;
    for (int row = 0; row < frame.height; ++row)
        for (int column = 0; column < frame.width; ++column) {
            const float* pixel = &frame.rgba[4 * (row * frame.width + column)];
            const double px = ((column + 0.5) / frame.width * 2 - 1) * camera.half_height * frame.width / frame.height;
            const double py = (1 - (row + 0.5) / frame.height * 2) * camera.half_height;
            const Vec3 d = normalized(camera.forward + px * camera.right + py * camera.up);
            double near = 0, far = 1e9, best = -1e9;
            for (int a = 0; a < 3; ++a) {
                const double p = (0 - camera.eye[a]) / d[a], q = (39 - camera.eye[a]) / d[a];
                near = std::max(near, std::min(p, q)), far = std::min(far, std::max(p, q));
            }
            if (far - near < 1) continue;  // corners, where rounding decides on the number of samples
            for (double t = near; t < far; t += 0.7) {
                const Vec3 p = camera.eye + (t + std::min(0.7, far - t) / 2) * d;
                best = std::max(best, f(p.x, p.y, p.z));
            }
            ASSERT_NEAR(pixel[0], (best + 100) / 300, 1e-3) << column << " " << row;
            ++hits;
        }
    EXPECT_GT(hits, 300);
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

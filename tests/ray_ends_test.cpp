// Rays that end at a depth: closed forms, and that nothing else changes.
#include <chiaro/error.h>
#include <chiaro/session.h>

#include <cstring>
#include <limits>

#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr float never = std::numeric_limits<float>::infinity();

/// The same everywhere, or by pixel.
template <class Mm>
std::shared_ptr<const RayEnds> ends(const Shot& shot, Mm&& mm) {
    RayEnds all{shot.width, shot.height, {}};
    for (int y = 0; y < shot.height; ++y)
        for (int x = 0; x < shot.width; ++x) all.mm.push_back(float(mm(x, y)));
    return std::make_shared<const RayEnds>(std::move(all));
}

bool same_bits(const Frame& a, const Frame& b) {
    return std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)) == 0;
}

}  // namespace

// T = exp(-κ s) of what lies before the end: s mm behind the entry, at any step, whichever way samples are taken.
TEST(RayEnds, CutConstantExtinctionWhereTheySay) {
    ConstantExtinction scene;
    const Volume& volume = scene.volume;
    Shot& shot = scene.shot;
    for (const double s : {-3.0, 0.0, 4.321, 17.0, 32.0, 50.0}) {
        shot.rays.ends = ends(shot, [&](int, int) { return scene.entry_mm + s; });
        const double expected = -std::expm1(-scene.per_mm * std::clamp(s, 0.0, 32.0));
        for (Isa isa : available_isas())
            for (const auto way : {Classification::post, Classification::pre, Classification::preintegrated})
                for (const auto order : {Compositing::front_to_back, Compositing::back_to_front})
                    for (const int rays : {1, 4}) {
                        shot.device.isa = isa, shot.rays.classification = way, shot.rays.compositing = order;
                        shot.rays.samples_per_pixel = rays;
                        EXPECT_NEAR(shot(volume).rgba[4 * (23 * 61 + 30) + 3], expected, 1e-3) << s;
                    }
    }
}

// A wall before half of the picture hides all behind it, and of the other half nothing.
TEST(RayEnds, AreEachPixelsOwn) {
    const Volume volume =
        sampled<std::uint8_t>({50, 50, 50}, [](double x, double y, double z) { return shells(x, y, z, 50); });
    Shot shot;
    shot.lighting.shading = Shading::phong;
    const Frame whole = shot(volume);
    shot.rays.ends = ends(shot, [](int, int) { return never; });
    EXPECT_TRUE(same_bits(shot(volume), whole));
    shot.rays.ends = ends(shot, [](int x, int) { return x < 30 ? 1 : never; });
    for (const RaySetup setup : {RaySetup::box, RaySetup::raster}) {
        shot.rays.ray_setup = setup;
        const Frame half = shot(volume);
        for (int y = 0; y < shot.height; ++y)
            for (int x = 0; x < shot.width; ++x) {
                const std::size_t i = 4 * std::size_t(y * shot.width + x);
                ASSERT_EQ(half.rgba[i + 3], x < 30 ? 0 : whole.rgba[i + 3]) << x << " " << y;
            }
    }
}

// What lies before the end and what lies behind it make the whole: clipped there, C = C1 + (1 - α1) C2.
TEST(RayEnds, LeaveWhatAClipWouldLeave) {
    const Volume volume =
        sampled<float>({41, 41, 41}, [](double x, double y, double z) { return shells(x, y, z, 41); });
    Shot shot;
    shot.camera = along_x;
    shot.rays.step_voxels = 0.05;
    const Camera camera = make_camera(along_x, volume.geometry, volume.dimensions);
    shot.rays.ends = ends(shot, [&](int, int) { return camera.eye.x - 17.5; });
    const Frame ended = shot(volume);
    shot.rays.ends = nullptr;
    shot.shape.clip.planes = {{{-1, 0, 0}, -17.5}};
    EXPECT_LT(difference(shot(volume), ended, 0).max, 0.01);
    EXPECT_GT(mean_alpha(ended), 0.05);
}

TEST(RayEnds, HoldForEveryModeAndForDepth) {
    const Volume volume = sampled<float>({41, 21, 21}, [](double x, double, double) { return x; });
    Shot shot;
    shot.camera = along_x;
    shot.tf.points = {{0, {0, 0, 0}, 1}, {40, {1, 1, 1}, 1}};
    shot.tf.rgb_space = RgbSpace::linear;
    const Camera camera = make_camera(along_x, volume.geometry, volume.dimensions);
    shot.rays.ends = ends(shot, [&](int, int) { return camera.eye.x - 30.0; });  // leaves x of 30 to 40
    const auto red = [&](Mode mode) {
        shot.shape.mode = mode;
        return shot(volume).rgba[4 * (23 * 61 + 30)];
    };
    EXPECT_NEAR(red(Mode::mip), 39.75 / 40, 1e-3);
    EXPECT_NEAR(red(Mode::minip), 30.25 / 40, 1e-3);
    EXPECT_NEAR(red(Mode::mean), 35.0 / 40, 1e-3);
    shot.shape.mode = Mode::iso;
    const auto depth = [&](double value) {
        shot.shape.iso = {{.value = value}};
        Frame frame(shot.width, shot.height);
        Progress progress;
        find_depth(shot.device, classify(upload(shot.device, volume), shot.tf, shot.shape), camera, shot.rays, frame,
                   progress);
        return frame.depth_mm[23 * 61 + 30];
    };
    EXPECT_NEAR(depth(33), camera.eye.x - 33, 0.01);
    EXPECT_EQ(depth(20), never);
}

TEST(RayEnds, OfAnotherPictureOrOfPathsAreRefused) {
    const Volume volume = sampled<std::uint8_t>({8, 8, 8}, [](double, double, double) { return 100; });
    Shot shot;
    shot.rays.ends = std::make_shared<const RayEnds>(RayEnds{10, 10, std::vector<float>(100, 1)});
    EXPECT_THROW(shot(volume), Error);
    shot.rays.ends = ends(shot, [](int, int) { return 1; });
    Scene scene;
    scene.width = shot.width, scene.height = shot.height, scene.sampling = shot.rays,
    scene.illumination = {.method = Method::reference};
    Session session(shot.device);
    Progress progress;
    session.show(volume, progress);
    EXPECT_THROW(session.render(scene, progress), Error);
}

// A session redoes rays for other ends, and keeps light.
TEST(RayEnds, OfASessionAreAnInputOfRaysAlone) {
    const Volume volume =
        sampled<std::uint8_t>({30, 30, 30}, [](double x, double y, double z) { return shells(x, y, z, 30); });
    Session session(tested_device());
    Progress progress;
    session.show(volume, progress);
    Scene scene;
    scene.width = 40, scene.height = 30;
    scene.transfer.points = two_materials();
    const Image whole = session.render(scene, progress);
    scene.sampling.ends = std::make_shared<const RayEnds>(RayEnds{40, 30, std::vector<float>(1200, 0)});
    const Image none = session.render(scene, progress);
    EXPECT_NE(none.pixels, whole.pixels);
    for (const Stage& stage : session.stages())
        if (stage.name == "illuminate" || stage.name == "classify" || stage.name == "fit")
            EXPECT_EQ(stage.seconds, 0) << stage.name;
    scene.sampling.ends = nullptr;
    EXPECT_EQ(session.render(scene, progress).pixels, whole.pixels);
}

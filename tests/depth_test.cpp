// How far it is to what is seen, against closed forms, and the same for every instruction set and thread.
#include <chiaro/session.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

Frame depths(const Shot& shot, const Volume& volume) {
    Frame frame(shot.width, shot.height);
    Progress progress;
    EXPECT_TRUE(find_depth(shot.device, classify(upload(shot.device, volume), shot.tf, shot.shape),
                           make_camera(shot.camera, volume.geometry, volume.dimensions), shot.rays, frame, progress));
    EXPECT_EQ(frame.depth_mm.size(), std::size_t(shot.width) * shot.height);
    return frame;
}

float at(const Frame& frame, int column, int row) { return frame.depth_mm[std::size_t(row) * frame.width + column]; }

/// The ray through a pixel's centre: its beginning and unit direction in the world.
std::pair<Vec3, Vec3> ray_of(const Camera& camera, const Frame& frame, int column, int row) {
    const double px = ((column + 0.5) / frame.width * 2 - 1) * camera.half_height * frame.width / frame.height,
                 py = (1 - (row + 0.5) / frame.height * 2) * camera.half_height;
    const Vec3 offset = px * camera.right + py * camera.up;
    if (camera.projection == Projection::orthographic) return {camera.eye + offset, camera.forward};
    return {camera.eye, normalized(camera.forward + offset)};
}

}  // namespace

// T = exp(-κ s) is ½ at s = ln 2 / κ behind the entry, whatever the step.
TEST(Depth, OfConstantExtinctionIsLogarithmOfTwo) {
    ConstantExtinction scene;
    const Volume& volume = scene.volume;
    Shot& shot = scene.shot;
    const double way_mm = std::log(2) / scene.per_mm, entry_mm = scene.entry_mm;
    for (const double step : {0.3, 1.0, 7.0})
        for (const auto way : {Classification::post, Classification::pre, Classification::preintegrated})
            for (const bool skip : {false, true}) {
                shot.rays.step_voxels = step, shot.rays.classification = way, shot.rays.skip_empty = skip;
                EXPECT_NEAR(at(depths(shot, volume), 30, 23), entry_mm + way_mm, 2e-3) << step;
            }
}

TEST(Depth, IsInfiniteWhereHalfIsNeverReached) {
    const Volume volume = sampled<std::uint8_t>({33, 33, 33}, [](double, double, double) { return 100; });
    Shot shot;
    shot.camera = along_x;
    shot.tf = constant(1 - std::pow(0.5, 1.01 / 32));  // over 32 voxels
    shot.rays.step_voxels = 0.7;
    EXPECT_TRUE(std::isfinite(at(depths(shot, volume), 30, 23)));
    EXPECT_TRUE(std::isinf(at(depths(shot, volume), 0, 0))) << "beside the volume";
    shot.tf = constant(1 - std::pow(0.5, 0.99 / 32));
    for (const float depth : depths(shot, volume).depth_mm) EXPECT_EQ(depth, std::numeric_limits<float>::infinity());
}

// An isosurface of a ball: the first crossing of each ray with the sphere, from the eye.
TEST(Depth, OfAnIsosurfaceIsTheFirstCrossing) {
    constexpr double radius = 12;
    Volume volume = sampled<float>({41, 41, 41}, [](double x, double y, double z) {
        return std::sqrt((x - 20) * (x - 20) + (y - 20) * (y - 20) + (z - 20) * (z - 20));
    });
    volume.geometry.origin_mm = {5, -3, 100};
    Shot shot;
    shot.shape.mode = Mode::iso;
    shot.shape.iso = {{radius, Rgb{1, 1, 1}, 1},
                      {radius + 4, Rgb{1, 0, 0}, 0.2}};  // the outer one, met twice, is not enough
    const Vec3 centre = volume.geometry.world_from_voxel({20, 20, 20});
    for (const auto projection : {Projection::perspective, Projection::orthographic}) {
        shot.camera.projection = projection;
        const Frame frame = depths(shot, volume);
        const Camera camera = make_camera(shot.camera, volume.geometry, volume.dimensions);
        int seen = 0;
        for (int row = 0; row < frame.height; ++row)
            for (int column = 0; column < frame.width; ++column) {
                const auto [from, along] = ray_of(camera, frame, column, row);
                const double middle = dot(centre - from, along);
                const Vec3 nearest = from + middle * along - centre;
                const double below = radius * radius - dot(nearest, nearest);
                if (below > 20) {
                    ASSERT_NEAR(at(frame, column, row), middle - std::sqrt(below), 0.1) << column << "," << row;
                    ++seen;
                }
                if (below < -1) {
                    ASSERT_TRUE(std::isinf(at(frame, column, row))) << column << "," << row;
                }
            }
        EXPECT_GT(seen, 100);
    }
}

TEST(Depth, OfAMaximumIsItsPlace) {
    const Volume volume =
        sampled<float>({64, 17, 17}, [](double x, double, double) { return 250 - 4 * std::abs(x - 40); });
    Shot shot;
    shot.camera = along_x;
    shot.shape.mode = Mode::mip;
    shot.rays.step_voxels = 0.25;
    const Camera camera = make_camera(shot.camera, volume.geometry, volume.dimensions);
    const double there = dot(volume.geometry.world_from_voxel({40, 8, 8}) - camera.eye, camera.forward);
    shot.tf = constant(0.6);
    for (const bool skip : {false, true}) {
        shot.rays.skip_empty = skip;
        EXPECT_NEAR(at(depths(shot, volume), 30, 23), there, 0.13);
    }
    shot.tf = constant(0.4);
    EXPECT_TRUE(std::isinf(at(depths(shot, volume), 30, 23)));
}

// A clip moves the entry; the order of compositing and where rays stop in the picture do not matter.
TEST(Depth, FollowsTheClipAndNothingElse) {
    const Volume volume = sampled<std::uint16_t>({65, 33, 33}, [](double, double, double) { return 100; });
    Shot shot;
    shot.camera = along_x;
    shot.tf = constant(0.2);
    const float whole = at(depths(shot, volume), 30, 23);
    shot.shape.clip.planes = {{{1, 0, 0}, 50}};
    EXPECT_NEAR(at(depths(shot, volume), 30, 23), whole + 14, 2e-3);
    const Frame clipped = depths(shot, volume);
    shot.rays.compositing = Compositing::back_to_front;
    shot.rays.early_termination = 0.3;
    shot.rays.samples_per_pixel = 4;
    EXPECT_EQ(depths(shot, volume).depth_mm, clipped.depth_mm);
}

template <class T>
void expect_equal_bits(double scale) {
    const Volume volume =
        sampled<T>({60, 60, 60}, [&](double x, double y, double z) { return scale * shells(x, y, z, 60); });
    Shot shot;
    for (auto& point : shot.tf.points) point.value *= scale;
    shot.width = 150, shot.height = 111;
    shot.device.isa = Isa::scalar, shot.device.threads = 1;
    const Frame one = depths(shot, volume);
    EXPECT_GT(std::count_if(one.depth_mm.begin(), one.depth_mm.end(), [](float d) { return std::isfinite(d); }), 2000);
    for (const Isa isa : available_isas())
        for (const int threads : {1, 3})
            for (const bool skip : {true, false}) {
                shot.device.isa = isa, shot.device.threads = threads, shot.rays.skip_empty = skip;
                EXPECT_EQ(
                    std::memcmp(depths(shot, volume).depth_mm.data(), one.depth_mm.data(), one.depth_mm.size() * 4), 0)
                    << name_of(isa) << " " << threads;
            }
}
TEST(Depth, IsTheSameEverywhereForBytes) { expect_equal_bits<std::uint8_t>(1); }
TEST(Depth, IsTheSameEverywhereForShorts) { expect_equal_bits<std::uint16_t>(37); }
TEST(Depth, IsTheSameEverywhereForFloats) { expect_equal_bits<float>(0.01); }

TEST(Depth, ASessionFindsItWhenAskedAndForgetsItWithThePicture) {
    Progress progress;
    Session session(tested_device());
    EXPECT_THROW(session.frame_with_depth(progress), Error);
    session.show(make_sample("ball", 32), progress);
    Scene scene;
    scene.volume = "sample:ball:32";
    scene.width = 64, scene.height = 48;
    session.render(scene, progress);
    EXPECT_TRUE(session.frame().depth_mm.empty());
    const std::vector<float> first = session.frame_with_depth(progress).depth_mm;
    ASSERT_EQ(first.size(), 64u * 48u);
    EXPECT_TRUE(std::isfinite(first[24 * 64 + 32]));
    EXPECT_EQ(session.frame().rgba.size(), 4 * first.size());
    scene.camera.zoom = 2;
    session.render(scene, progress);
    EXPECT_TRUE(session.frame().depth_mm.empty());
    EXPECT_LT(session.frame_with_depth(progress).depth_mm[24 * 64 + 32], first[24 * 64 + 32]);
    scene.transfer.opacity_scale = 0.5;
    session.preview(scene, progress);
    EXPECT_THROW(session.frame_with_depth(progress), Error) << "the frame is of other matter";
}

TEST(Depth, CanBeCancelled) {
    const Volume volume = sampled<std::uint8_t>({20, 20, 20}, [](double, double, double) { return 100; });
    Frame frame(64, 64);
    Progress progress;
    progress.cancel();
    EXPECT_FALSE(find_depth(tested_device(), classify(upload(tested_device(), volume), constant(0.5), {}),
                            make_camera({}, volume.geometry, volume.dimensions), {}, frame, progress));
    EXPECT_TRUE(frame.depth_mm.empty());
}

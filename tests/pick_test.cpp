// What is picked, against closed forms, and against what the ray caster draws.
#include <gtest/gtest.h>

#include <cmath>

#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// The pick in the middle of a picture, whose ray is the volume's x axis, met from its far end.
std::optional<Pick> middle(const Shot& shot, const Volume& volume, double x = 30.5, double y = 23.5) {
    return pick(classify(upload(shot.device, volume), shot.tf, shot.shape),
                make_camera(shot.camera, volume.geometry, volume.dimensions), shot.rays, shot.width, shot.height, x, y);
}

/// κ = strength · x per voxel.
TransferFunction rising(double strength, int last) {
    TransferFunction tf;
    tf.rgb_space = RgbSpace::linear;
    for (int i = 0; i <= 64 * last; ++i) tf.points.push_back({i / 64.0, {1, 1, 1}, -std::expm1(-strength * i / 64.0)});
    return tf;
}

}  // namespace

// κ(s) = a s along the ray: T κ = a s exp(-a s²/2) is largest at s = 1/√a.
TEST(Pick, IsTheLargestContribution) {
    constexpr double a = 0.01;
    const Volume volume = sampled<float>({65, 9, 9}, [](double x, double, double) { return 64 - x; });
    Shot shot;
    shot.tf = rising(a, 64);
    shot.camera = along_x;
    shot.rays.step_voxels = 0.1;
    for (const auto way : {Classification::post, Classification::preintegrated}) {
        shot.rays.classification = way;
        const auto seen = middle(shot, volume);
        ASSERT_TRUE(seen);
        EXPECT_NEAR(seen->value, 1 / std::sqrt(a), 0.3);  // flat there: 1 - 1e-3, and the table has steps of 1/64
        EXPECT_NEAR(seen->p_voxel.x, 64 - seen->value, 0.06);
        EXPECT_NEAR(seen->weight, 0.1 * std::sqrt(a) * std::exp(-0.5), 2e-4);
        EXPECT_NEAR(seen->covered, 1 - std::exp(-a * 64 * 64 / 2), 1e-4);
        EXPECT_NEAR(seen->opacity, -std::expm1(-a * seen->value), 2e-3);
    }
}

TEST(Pick, CoversWhatTheRayCasterCovers) {
    const Volume volume =
        sampled<std::uint8_t>({40, 40, 40}, [](double x, double y, double z) { return shells(x, y, z, 40); });
    Shot shot;
    for (const auto order : {Compositing::front_to_back, Compositing::back_to_front}) {
        shot.rays.compositing = order;
        const Frame frame = shot(volume);
        for (int row = 1; row < shot.height; row += 5)
            for (int column = 2; column < shot.width; column += 7) {
                const auto seen = middle(shot, volume, column + 0.5, row + 0.5);
                const float alpha = frame.rgba[4 * (std::size_t(row) * frame.width + column) + 3];
                ASSERT_NEAR(seen ? seen->covered : 0, alpha, 2e-5) << column << "," << row;
                if (seen) {
                    ASSERT_LE(seen->weight, seen->covered + 1e-6);
                }
            }
    }
}

// The world point that was picked lies on the pixel's ray.
TEST(Pick, ProjectsBackToItsPixel) {
    Volume volume = sampled<std::uint8_t>({40, 30, 20}, [](double, double, double) { return 200; });
    volume.geometry.spacing_mm = {1, 1.5, 2};
    volume.geometry.origin_mm = {-7, 3, 11};
    Shot shot;
    for (const auto projection : {Projection::perspective, Projection::orthographic}) {
        shot.camera.projection = projection;
        const auto seen = middle(shot, volume, 37.25, 20.75);
        ASSERT_TRUE(seen);
        const Camera camera = make_camera(shot.camera, volume.geometry, volume.dimensions);
        const Vec3 d = seen->world_mm - camera.eye;
        const double depth = projection == Projection::perspective ? dot(d, camera.forward) : 1;
        const double px = dot(d, camera.right) / depth, py = dot(d, camera.up) / depth;
        EXPECT_NEAR((px * shot.height / (camera.half_height * shot.width) + 1) * shot.width / 2, 37.25, 1e-3);
        EXPECT_NEAR((1 - py / camera.half_height) * shot.height / 2, 20.75, 1e-3);
        EXPECT_NEAR(seen->depth_mm, projection == Projection::perspective ? length(d) : dot(d, camera.forward), 1e-6);
    }
}

TEST(Pick, FindsSurfacesWhereTheyAre) {
    const Volume volume = sampled<float>({65, 9, 9}, [](double x, double, double) { return x; });
    Shot shot;
    shot.tf = constant(0.5);
    shot.camera = along_x;
    shot.shape.mode = Mode::iso;
    shot.shape.iso = {{20, Rgb{1, 0, 0}, 0.9}, {40.25, Rgb{0, 0, 1}, 0.2}};
    const auto seen = middle(shot, volume);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->value, 20, 1e-4);  // 0.8 · 0.9 behind 0.2
    EXPECT_NEAR(seen->p_voxel.x, 20, 1e-3);
    EXPECT_NEAR(seen->weight, 0.72, 1e-5);
    EXPECT_NEAR(seen->opacity, 0.9, 1e-6);
    EXPECT_NEAR(seen->rgb[0], 1, 1e-6);
    EXPECT_NEAR(seen->rgb[2], 0, 1e-6);
}

TEST(Pick, FindsTheLargestValue) {
    const Volume volume = sampled<float>({65, 9, 9}, [](double x, double, double) { return 100 - std::abs(x - 23); });
    Shot shot;
    shot.tf = constant(0.5);
    shot.camera = along_x;
    shot.shape.mode = Mode::mip;
    const auto seen = middle(shot, volume);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->value, 100, 0.3);
    EXPECT_NEAR(seen->p_voxel.x, 23, 0.3);
}

TEST(Pick, FindsNothingInTheEmptyAndBehindCuts) {
    const Volume volume = sampled<float>({65, 9, 9}, [](double x, double, double) { return x; });
    Shot shot;
    shot.camera = along_x;
    shot.tf = constant(0);
    EXPECT_FALSE(middle(shot, volume));
    shot.tf = constant(0.3);
    EXPECT_FALSE(middle(shot, volume, 0.5, 0.5)) << "beside the volume";
    shot.shape.clip.box = std::array<double, 6>{0, 0.5, 0, 1, 0, 1};
    const auto cut = middle(shot, volume);
    ASSERT_TRUE(cut);
    EXPECT_NEAR(cut->p_voxel.x, 32 - 0.25, 1e-3) << "the first sample behind the cut";
}

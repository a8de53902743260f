// Pre- and pre-integrated classification, the order of compositing, and their truths.
#include <gtest/gtest.h>

#include <algorithm>

#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

double psnr(const Frame& a, const Frame& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double(a.rgba[i]) - b.rgba[i], 2);
    return -10 * std::log10(sum / double(a.rgba.size()));
}

/// Thin opaque skins, four values wide.
TransferFunction steep(double scale = 1) {
    TransferFunction tf;
    tf.points = {{90 * scale, {0.9, 0.3, 0.1}, 0},      {92 * scale, {0.9, 0.6, 0.1}, 0.9},
                 {94 * scale, {0.9, 0.3, 0.1}, 0},      {160 * scale, {0.1, 0.3, 0.9}, 0},
                 {162 * scale, {0.1, 0.5, 0.9}, 0.999}, {164 * scale, {0.2, 0.9, 0.3}, 0}};
    return tf;
}

/// Smooth bodies: some fifteen values a voxel, so that a step of one voxel passes a skin unseen.
template <class T>
DeviceVolume waves(double scale = 1) {
    return upload(tested_device(), sampled<T>({64, 64, 64}, [&](double x, double y, double z) {
                      return scale * (128 + 110 * std::sin(0.15 * x) * std::sin(0.13 * y + 1) * std::cos(0.14 * z));
                  }));
}

Frame shot_at(Shot shot, const DeviceVolume& volume, double step, Classification classification) {
    shot.rays.step_voxels = step;
    shot.rays.classification = classification;
    return shot(volume);
}

/// Pre-integrated at step 1 against post-classified, both by their distance to the picture of fine steps.
template <class T>
void expect_ten_decibels(double scale, Shading shading) {
    const DeviceVolume volume = waves<T>(scale);
    Shot shot;
    shot.tf = steep(scale);
    shot.lighting.shading = shading;
    const Frame fine = shot_at(shot, volume, 0.01, Classification::post);
    const double post = psnr(shot_at(shot, volume, 1, Classification::post), fine);
    const double preintegrated = psnr(shot_at(shot, volume, 1, Classification::preintegrated), fine);
    EXPECT_GT(preintegrated, post + 10);
    EXPECT_GT(mean_alpha(fine), 0.1);
}

}  // namespace

TEST(Preintegration, IsTenDecibelsNearerForBytes) { expect_ten_decibels<std::uint8_t>(1, Shading::none); }
TEST(Preintegration, IsTenDecibelsNearerForShorts) { expect_ten_decibels<std::uint16_t>(100, Shading::none); }
TEST(Preintegration, IsTenDecibelsNearerForFloats) { expect_ten_decibels<float>(0.01, Shading::none); }
TEST(Preintegration, IsTenDecibelsNearerWhereShaded) { expect_ten_decibels<std::uint8_t>(1, Shading::phong); }

TEST(Preintegration, ConvergesToTheImageOfFineSteps) {
    const DeviceVolume volume = waves<float>();
    Shot shot;
    shot.tf = steep();
    const Frame fine = shot_at(shot, volume, 0.01, Classification::post);
    double last = 0;
    for (double step : {2.0, 1.0, 0.5, 0.25, 0.125}) {
        const double decibels = psnr(shot_at(shot, volume, step, Classification::preintegrated), fine);
        EXPECT_GT(decibels, std::min(last, 55.0)) << step;  // what the nodes cannot tell apart
        last = decibels;
    }
    EXPECT_GT(last, 55);
}

// Along a ramp each step runs evenly from one value to another, so a few long steps give the whole integral.
TEST(Preintegration, OfARampIsExactAtAnyStep) {
    const DeviceVolume ramp =
        upload(tested_device(), sampled<float>({64, 9, 9}, [](double x, double, double) { return 4 * x; }));
    Shot shot;
    shot.tf.points = {{0, {1, 0, 0}, 0.05}, {100, {0, 1, 0}, 0.1}, {120, {0, 0, 1}, 0.5}, {252, {1, 1, 1}, 0.02}};
    shot.camera = {.azimuth_deg = 0, .elevation_deg = 0, .projection = Projection::orthographic};
    const Frame fine = shot_at(shot, ramp, 0.01, Classification::post);
    for (double step : {0.7, 3.0, 9.1, 63.0}) {
        EXPECT_LT(difference(shot_at(shot, ramp, step, Classification::preintegrated), fine, 0).max, 4e-3) << step;
        shot.rays.compositing = Compositing::back_to_front;
    }
}

// A peak that lies between the values of two neighbours is met by every ray.
TEST(Preintegration, MissesNoPeak) {
    const DeviceVolume edge =
        upload(tested_device(),
               sampled<std::uint8_t>({40, 40, 40}, [](double x, double, double) { return x < 20 ? 0 : 200; }));
    Shot shot;
    shot.tf.points = {{58, {1, 1, 1}, 0}, {60, {1, 1, 1}, 0.9999}, {62, {1, 1, 1}, 0}};
    shot.tf.opacity_unit = 0.01;
    shot.camera = {.azimuth_deg = 0, .elevation_deg = 0, .projection = Projection::orthographic};
    EXPECT_LT(shot_at(shot, edge, 1, Classification::post).rgba[4 * (23 * 61 + 30) + 3], 0.01);
    EXPECT_NEAR(shot_at(shot, edge, 1, Classification::preintegrated).rgba[4 * (23 * 61 + 30) + 3],
                shot_at(shot, edge, 0.001, Classification::post).rgba[4 * (23 * 61 + 30) + 3], 0.01);
}

// Between an empty and a full voxel the opacity of a step grows evenly: 1 - (1 - t α)^n.
TEST(Preclassification, InterpolatesOpacities) {
    const DeviceVolume edge = upload(
        tested_device(), sampled<std::uint8_t>({2, 9, 2}, [](double x, double, double) { return x < 1 ? 0 : 200; }));
    Shot shot;
    shot.tf.points = {{195, {1, 1, 1}, 0}, {196, {1, 1, 1}, 0.2}, {255, {1, 1, 1}, 0.2}};
    shot.camera = {.azimuth_deg = -90, .elevation_deg = 0, .zoom = 3, .projection = Projection::orthographic};
    const Frame frame = shot_at(shot, edge, 1, Classification::pre);
    const double mm = length(Vec3{1, 8, 1}) / 3 / frame.height;  // of a pixel
    int inside = 0;
    for (int column = 0; column < frame.width; ++column) {
        const double t = 0.5 + (column - 30) * mm;
        if (t < 0 || t > 1) continue;
        EXPECT_NEAR(frame.rgba[4 * (23 * 61 + column) + 3], 1 - std::pow(1 - 0.2 * t, 8), 1e-4) << t;
        ++inside;
    }
    EXPECT_GT(inside, 15);
}

// On the way from a blue ball to the air around it post-classification meets the values of everything in between.
TEST(Preclassification, HasNoHalos) {
    const DeviceVolume cornell =
        upload(tested_device(), sampled<std::uint8_t>({48, 48, 48}, [](double x, double y, double z) {
                   return length(Vec3{x, y, z} - Vec3{24, 24, 24}) < 15 ? 200 : 0;
               }));
    Shot shot;
    shot.tf = sample_transfer_function("cornell");
    const auto reddest = [&](Classification classification) {
        double most = 0;
        const Frame frame = shot_at(shot, cornell, 0.5, classification);
        for (std::size_t p = 0; p < frame.rgba.size(); p += 4)
            most = std::max(most, double(frame.rgba[p]) - frame.rgba[p + 2]);
        EXPECT_GT(mean_alpha(frame), 0.05);
        return most;
    };
    EXPECT_GT(reddest(Classification::post), 0.2);
    EXPECT_LE(reddest(Classification::pre), 0);
}

TEST(Compositing, BothOrdersGiveTheSameImage) {
    const DeviceVolume volume =
        upload(tested_device(),
               sampled<std::uint8_t>({50, 50, 50}, [](double x, double y, double z) { return shells(x, y, z, 50); }));
    for (Mode mode : {Mode::dvr, Mode::iso, Mode::mip})
        for (Classification classification :
             {Classification::post, Classification::pre, Classification::preintegrated}) {
            Shot shot;
            shot.lighting.shading = Shading::phong;
            shot.shape = {.mode = mode,
                          .iso = {{40, {}, 0.3}, {100, {}, 0.6}, {150}},
                          .clip = {.box = std::array{0.0, 1.0, 0.0, 1.0, 0.0, 0.6}}};
            shot.rays.classification = classification;
            const Frame forwards = shot(volume);
            shot.rays.compositing = Compositing::back_to_front;
            EXPECT_LE(difference(shot(volume), forwards, 0).max, 1e-5) << int(mode) << int(classification);
            EXPECT_GT(mean_alpha(forwards), 0.02);
        }
}

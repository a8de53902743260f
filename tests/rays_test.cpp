// Where rays begin and end, and how many of them a pixel has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "fixtures.h"
#include "raycast/bounds.h"
#include "raycast/views.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

bool same_bits(const Frame& a, const Frame& b) {
    return std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)) == 0;
}

/// Small balls far apart, and a hollow around the middle.
double balls(double x, double y, double z) {
    double value = 0;
    for (const Vec3 c : {Vec3{10, 12, 50}, Vec3{70, 15, 22}, Vec3{35, 72, 68}, Vec3{75, 70, 10}, Vec3{12, 60, 14}})
        value = std::max(value, 200 - 30 * length(Vec3{x, y, z} - c));
    return std::max(value, 0.0);
}

struct Placed {
    const char* name;
    CameraSettings camera;
};
const Placed cameras[] = {
    {"outside", {}},
    {"above", {.elevation_deg = 90, .projection = Projection::orthographic}},
    {"along an axis", {.azimuth_deg = 90, .elevation_deg = 0, .projection = Projection::orthographic}},
    {"near", {.azimuth_deg = 20, .elevation_deg = 10, .zoom = 2, .projection = Projection::orthographic}},
    {"in the hollow", {.fov_deg = 120, .eye = Vec3{40, 40, 40}, .target = Vec3{75, 70, 10}}},
    {"in a ball", {.fov_deg = 150, .eye = Vec3{35, 72, 68}, .target = Vec3{10, 12, 50}}},
    {"on a face", {.fov_deg = 90, .eye = Vec3{64, 20, 16}, .target = Vec3{70, 15, 22}}},
};

}  // namespace

TEST(RaySetup, BothGiveTheSameImage) {
    const DeviceVolume volume = upload(tested_device(), sampled<std::uint8_t>({86, 84, 81}, balls));
    for (const auto& [name, camera] : cameras)
        for (Mode mode : {Mode::dvr, Mode::iso, Mode::mip})
            for (int rays : {1, 5}) {
                Shot shot;
                shot.lighting.shading = Shading::phong;
                shot.camera = camera;
                shot.shape = {.mode = mode, .iso = {{90, {}, 0.5}}};
                shot.rays.samples_per_pixel = rays;
                const Frame box = shot(volume);
                shot.rays.ray_setup = RaySetup::raster;
                EXPECT_TRUE(same_bits(shot(volume), box)) << name << " " << int(mode) << " rays " << rays;
                EXPECT_GT(mean_alpha(box), 0.0005) << name;
            }
}

TEST(RaySetup, WorksForOneSliceAndOneVoxel) {
    for (const std::array<int, 3> n : {std::array{40, 33, 1}, std::array{1, 1, 1}, std::array{1, 50, 2}}) {
        const DeviceVolume volume =
            upload(tested_device(), sampled<std::uint8_t>(n, [](double, double, double) { return 200; }));
        Shot shot;
        const Frame box = shot(volume);
        shot.rays.ray_setup = RaySetup::raster;
        EXPECT_TRUE(same_bits(shot(volume), box)) << n[0];
        EXPECT_GT(mean_alpha(box), 0.005);
    }
}

TEST(RaySetup, RasterisingLeavesEmptySpaceOut) {
    const Device device = Device::cpu(2);  // GPUs set rays up at the box
    const DeviceVolume volume = upload(device, sampled<std::uint8_t>({86, 84, 81}, balls));
    const Medium medium = classify(volume, two_materials(), {});
    Progress progress;
    Frame frame(64, 64);
    const auto samples = [&](RaySetup setup) {
        return raycast(device, medium, IlluminationField(), {}, make_camera({}, volume.geometry(), volume.dimensions()),
                       {.ray_setup = setup, .early_termination = 0, .skip_empty = false}, frame, progress)
            .samples;
    };
    EXPECT_LT(samples(RaySetup::raster), samples(RaySetup::box) / 3);
    EXPECT_GT(samples(RaySetup::raster), 0u);
}

TEST(SamplesPerPixel, LieEvenlyInThePixel) {
    EXPECT_EQ(kernel::sub_pixel(0, 1).x, 0);
    EXPECT_EQ(kernel::sub_pixel(0, 1).y, 0);
    for (int n : {2, 4, 7, 16, 64}) {
        double x = 0, y = 0;
        std::set<int> columns, rows;
        for (int i = 0; i < n; ++i) {
            const kernel::SubPixel p = kernel::sub_pixel(i, n);
            EXPECT_LT(std::max(std::abs(p.x), std::abs(p.y)), 0.5);
            x += p.x / n, y += p.y / n;
            columns.insert(int((p.x + 0.5) * n)), rows.insert(int((p.y + 0.5) * n));
        }
        EXPECT_NEAR(x, 0, 1e-6) << n;
        EXPECT_EQ(int(columns.size()), n);
        if ((n & (n - 1)) == 0) {
            EXPECT_NEAR(y, 0, 1e-6) << n;
            EXPECT_EQ(int(rows.size()), n);
        }
    }
}

// A pixel of many rays is the mean of the pixels of a larger picture, premultiplied.
TEST(SamplesPerPixel, AverageWhatALargerImageShows) {
    const DeviceVolume volume = upload(tested_device(), sampled<std::uint8_t>({86, 84, 81}, balls));
    Shot shot{.width = 40, .height = 30};
    shot.lighting.shading = Shading::phong;
    shot.rays.samples_per_pixel = 64;
    const Frame frame = shot(volume);
    shot.rays.samples_per_pixel = 1;
    const Frame plain = shot(volume);
    shot.width *= 8, shot.height *= 8;
    const Frame large = shot(volume);
    double error = 0, error_of_one = 0;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x)
            for (int c = 0; c < 4; ++c) {
                double mean = 0;
                for (int j = 0; j < 8; ++j)
                    for (int i = 0; i < 8; ++i)
                        mean += large.rgba[4 * (std::size_t(8 * y + j) * large.width + 8 * x + i) + c] / 64.0;
                const std::size_t at = 4 * (std::size_t(y) * frame.width + x) + c;
                error += std::pow(frame.rgba[at] - mean, 2), error_of_one += std::pow(plain.rgba[at] - mean, 2);
            }
    EXPECT_LT(error, error_of_one / 100);
    EXPECT_GT(error_of_one, 0.01);
}

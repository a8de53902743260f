// Volumes that are kept in chunks: a ball of numbers for them to hold, and its pictures by bricks.
#pragma once
#include <chiaro/session.h>

#include <cmath>
#include <limits>

#include "volume_files.h"

namespace volume_files {

using namespace chiaro;

template <class T>
std::vector<T> voxels_in(const BrickSource& source, int level, const VoxelBox& box) {
    std::vector<T> voxels(std::size_t(box.size[0]) * box.size[1] * box.size[2]);
    source.read(level, box, reinterpret_cast<std::byte*>(voxels.data()));
    return voxels;
}

/// A ball, a speck that no coarse level has, and numbers that are none, of n³ voxels.
inline std::vector<float> ball(int n) {
    std::vector<float> voxels(std::size_t(n * n * n));
    const auto at = [&](int x, int y, int z) -> float& { return voxels[std::size_t((z * n + y) * n + x)]; };
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) at(x, y, z) = 40 - std::hypot(float(x) - 64, float(y) - 64, float(z) - 64);
    for (int i = 0; i < 3; ++i) at(10 + i % 2, 12, 110 - i / 2) = 500;
    at(64, 64, 30) = at(65, 64, 31) = std::numeric_limits<float>::quiet_NaN();
    at(0, 0, 0) = -300;
    return voxels;
}

struct Chunks : ::testing::Test {
    static constexpr int n = 128;
    const Folder folder;
    const std::vector<float> voxels = ball(n);
    Progress progress{};
};

inline std::vector<std::uint8_t> picture(Session& session, Progress& progress) {
    Scene scene = scene_of_volume("");
    scene.width = 240, scene.height = 200;
    scene.camera.fit = Fit::volume;
    scene.camera.zoom = 1.2;
    scene.interpolation = Interpolation::linear;
    scene.illumination.method = Method::none;
    TransferFunction tf;
    tf.points = {{0, {1, 0.8, 0.5}, 0}, {2, {1, 0.8, 0.5}, 0.4}, {60, {0.9, 0.2, 0.1}, 0.9}, {500, {0, 0, 1}, 1}};
    scene.transfer.points = tf;
    return session.render(scene, progress).pixels;
}

inline void expect_same_pictures(const std::string& name, Progress& progress) {
    Session paged(Device::cpu(2)), whole(Device::cpu(2));
    const auto source = open_brick_source(name, {});
    ASSERT_TRUE(source);
    paged.show(source, {.memory_bytes = 20 << 20, .exact = true}, progress);
    whole.show(read_volume(name, {}, progress), progress);
    EXPECT_EQ(picture(paged, progress), picture(whole, progress));
    ASSERT_TRUE(paged.paging());
    EXPECT_EQ(paged.paging()->level, 0);
    EXPECT_GT(paged.paging()->bricks, 0u);
}

}  // namespace volume_files

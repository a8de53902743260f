// What the server takes things to need, against what they take.
#include <gtest/gtest.h>

#include "server/memory_budget.h"

#include <chiaro/chiaro.h>

namespace chiaro {
namespace {

TEST(Room, IsMadeForBricksAsTheyAre) {
    for (const VoxelType type : {VoxelType::u8, VoxelType::i16, VoxelType::f32})
        for (const std::array<int, 3> size : {std::array{64, 64, 64}, std::array{33, 70, 1}, std::array{34, 2, 100}}) {
            const Volume volume = make_volume(size, type);
            const double ranges = 8.0 * (size[0] / 4 + 1) * (size[1] / 4 + 1) * (size[2] / 4 + 1);
            const double held = double(upload(Device::cpu(1), volume).bytes());
            EXPECT_LE(server::brick_bytes(volume), held) << size[0] << " " << name_of(type);
            EXPECT_GE(server::brick_bytes(volume) + ranges + 16, held) << size[0] << " " << name_of(type);
        }
    const Volume large = make_volume({512, 512, 512}, VoxelType::u16);
    EXPECT_NEAR(server::brick_bytes(large) / double(large.voxels.size()), 1.31, 0.01);
    EXPECT_EQ(server::brick_bytes(make_volume({64, 64, 64}, VoxelType::f64)),
              server::brick_bytes(make_volume({64, 64, 64}, VoxelType::f32)));  // as which they are stored
}

TEST(Room, IsMadeForTheLightOfEachMethod) {
    constexpr int size = 48;
    Progress progress;
    Session session(Device::cpu(2));
    session.show(make_sample("shells", size), progress);
    Scene scene;
    scene.width = 32, scene.height = 24;
    scene.lighting.probe.source = "sky";
    for (const Method method : {Method::spao, Method::visibility, Method::transport}) {
        scene.illumination = {.method = method};
        scene.illumination.transport.grid = 32;
        session.render(scene, progress);
        const double needed = server::light_bytes(scene.illumination, double(size) * size * size);
        EXPECT_GE(needed, double(session.light_bytes())) << int(method);
        EXPECT_GT(session.light_bytes(), 0u) << int(method);
    }
    // No light grid is finer than the volume, however fine it is asked for.
    const IlluminationSettings fine{.method = Method::transport, .transport = {.grid = 256}};
    EXPECT_LT(server::light_bytes(fine, 1000), 1e6);
    EXPECT_EQ(server::light_bytes({.method = Method::none}, 1e9), 0);
}

}  // namespace
}  // namespace chiaro

// What frames of ranks owe to the voxels around their blocks, and how fine the light is that they keep.
#include <chiaro/camera.h>
#include <chiaro/render.h>
#include <chiaro/samples.h>
#include <chiaro/text.h>

#include "rank_frames.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// Floats whose steep walls rays graze.
Volume balls() {
    Volume whole = make_volume({81, 66, 72}, VoxelType::f32);
    constexpr float all[3][4]{{40, 33, 30, 20}, {25, 25, 52, 10}, {58, 44, 48, 12}};  // centre and radius
    float* to = whole.as<float>().data();
    for (int z = 0; z < 72; ++z)
        for (int y = 0; y < 66; ++y)
            for (int x = 0; x < 81; ++x) {
                float near = 0;
                for (const auto& [a, b, c, r] : all)
                    near = std::max(near, 1.5f - std::hypot(float(x) - a, float(y) - b, float(z) - c) / r);
                *to++ = 200 * std::min(near, 1.0f) + 10 * std::sin(float(x) / 3) * std::sin(float(y) / 4);
            }
    return whole;
}

TransferFunction steep() {
    TransferFunction tf;
    tf.points = {{73, {0.5, 0.5, 0.7}, 0}, {126, {0.9, 0.8, 0.6}, 0.5}, {210, {0.8, 0.2, 0.1}, 0.9}};
    tf.opacity_unit = 1.7;
    return tf;
}

struct Lit {
    IlluminationField field;
    Medium medium;
};
Lit light(const Device& device, const Volume& volume, const IlluminationSettings& settings) {
    Progress progress;
    Lit lit;
    lit.medium = classify(upload(device, volume), steep(), {});
    illuminate(
        device, lit.medium, Prepared(), {}, settings, [&](IlluminationField finer) { lit.field = std::move(finer); },
        progress);
    return lit;
}

const std::vector<std::vector<Cut>> two_three_eight{
    {{0, 2, 36}},
    {{0, 2, 24}, {1, 2, 48}},
    {{0, 0, 41}, {0, 1, 33}, {1, 1, 33}, {0, 2, 36}, {1, 2, 36}, {2, 2, 36}, {3, 2, 36}}};

/// `of_ghosts`: of each block, on each side.
void check_pictures(Method method, int of_ghosts) {
    const Volume whole = balls();
    CameraSettings seen;
    seen.azimuth_deg = 52, seen.elevation_deg = 23;
    const Camera camera = make_camera(seen, whole.geometry, whole.dimensions);
    IlluminationSettings settings;
    settings.method = method, settings.transport.error = 0.05;
    const auto draw = [&](const Device& device, const Volume& volume) {
        const Lit lit = light(device, volume, settings);
        Progress progress;
        Frame frame(480, 360);
        raycast(device, lit.medium, lit.field, {}, camera, {.early_termination = 0}, frame, progress);
        return frame;
    };
    const Frame one = draw(Device::cpu(1), whole);
    for (const std::vector<Cut>& cuts : two_three_eight) {
        const std::vector<OwnVoxels> blocks = cut_up(whole.dimensions, cuts);
        SCOPED_TRACE(std::string(to_text(method)) + " by " + std::to_string(blocks.size()) + " ranks");
        std::vector<Frame> frames(blocks.size());
        on_ranks(int(blocks.size()), [&](std::shared_ptr<ThreadExchange> ranks) {
            Device device = Device::cpu(1);
            device.ranks = ranks;
            const auto rank = std::size_t(ranks->rank());
            frames[rank] = draw(device, block_of(whole, blocks[rank], of_ghosts));
        });
        std::vector<Placement> places;
        for (const OwnVoxels& own : blocks) places.push_back({whole.dimensions, {}, own.first, own.end});
        check_same(blended(frames, front_to_back(places, whole.geometry, camera)), one);
    }
}

// The surface that a ray has met tells the light of what lies behind it, and which one that is depends on the one
// before: along a wall a rank must begin so far before its block as its ghosts reach. With 8 some pixels are 5 off.
TEST(RanksWalls, BlendWhatRaysGraze) {
    for (const Method method : {Method::spao, Method::visibility, Method::transport}) check_pictures(method, 16);
}

/// Longer than 256 nodes.
Volume rod() {
    Progress progress;
    const Volume tubes = make_sample("tubes", 64, progress);
    Volume whole = make_volume({20, 24, 700}, VoxelType::u8);
    for (int z = 0; z < 700; ++z)
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 20; ++x)
                whole.as<std::uint8_t>()[(std::size_t(z) * 24 + std::size_t(y)) * 20 + std::size_t(x)] =
                    tubes.as<std::uint8_t>()[(std::size_t(z % 64) * 64 + std::size_t(y + 20)) * 64 +
                                             std::size_t(x + 20)];
    return whole;
}

// Nodes of every second cell would be 350: ranks take every fourth, as one rank that is told so.
TEST(RanksWalls, KeepLightOf256NodesAsOneThatIsToldSo) {
    const Volume whole = rod();
    IlluminationSettings asked, told;
    asked.method = told.method = Method::visibility;
    asked.visibility.directions = told.visibility.directions = 64;
    told.visibility.subsample = 4;
    const auto one = found(light(Device::cpu(1), whole, told).field);
    EXPECT_NE(one, found(light(Device::cpu(1), whole, asked).field));
    on_ranks(3, [&](std::shared_ptr<ThreadExchange> ranks) {
        Device device = Device::cpu(1);
        device.ranks = ranks;
        const OwnVoxels own = cut_up(whole.dimensions, {{0, 2, 200}, {1, 2, 455}})[std::size_t(ranks->rank())];
        EXPECT_EQ(one, found(light(device, block_of(whole, own, 8), asked).field));
    });
    // Of transport no volume's grid is wider, and one rank's of 256 is theirs.
    asked.method = told.method = Method::transport;
    asked.transport.grid = told.transport.grid = 256;
    asked.transport.error = told.transport.error = 0.2;
    const auto widest = found(light(Device::cpu(1), whole, told).field);
    on_ranks(2, [&](std::shared_ptr<ThreadExchange> ranks) {
        Device device = Device::cpu(1);
        device.ranks = ranks;
        const OwnVoxels own = cut_up(whole.dimensions, {{0, 2, 301}})[std::size_t(ranks->rank())];
        EXPECT_EQ(widest, found(light(device, block_of(whole, own, 8), asked).field));
    });
}

}  // namespace

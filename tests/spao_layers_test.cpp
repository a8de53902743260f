// SPAO layer by layer of blocks, as pictures have it, against its steps one after the other over the whole volume.
#include <chiaro/medium.h>
#include <gtest/gtest.h>

#include <cstring>

#include "classify/medium.h"
#include "fixtures.h"
#include "illumination/cells/surface_share.h"
#include "illumination/spao/layers.h"
#include "illumination/spao/spao.h"

namespace chiaro {
namespace {

struct Lit {
    CellValues light;
    std::vector<std::string> steps;
};

std::vector<std::string> names_of(const StageTimer& timer) {
    std::vector<std::string> names;
    for (const Stage& stage : timer.stages()) names.push_back(stage.name);
    return names;
}

Lit in_layers(const Device& device, const Medium& medium, const SpaoSettings& settings) {
    StageTimer timer;
    Progress progress;
    CellValues light = spao_light(device, medium.data(), settings, timer, progress);
    return {std::move(light), names_of(timer)};
}

Lit at_once(const Device& device, const Medium& medium, const SpaoSettings& settings) {
    StageTimer timer;
    Progress progress;
    const CellOpacity opacity = timer("opacity", [&] { return cell_opacity(device, medium.data(), progress); });
    const BlockMap read = visible_blocks(medium.data(), opacity.values.grid, access_reach);
    CellValues light = spao_accessibility(device, opacity, settings, read, timer, progress, true);
    return {std::move(light), names_of(timer)};
}

/// Of all cells, those that no ray sees included.
void expect_same(const Medium& medium, const SpaoSettings& settings, const std::string& what) {
    const Lit whole = at_once(Device::cpu(2), medium, settings);
    for (const int threads : {1, 3}) {
        const Lit layers = in_layers(Device::cpu(threads), medium, settings);
        ASSERT_EQ(layers.light.grid.count, whole.light.grid.count) << what;
        EXPECT_EQ(std::memcmp(layers.light.data(), whole.light.data(), whole.light.grid.size() * 2), 0)
            << what << ", levels " << settings.levels;
        if (settings.levels > 2) EXPECT_EQ(layers.steps, whole.steps) << what;  // below there is no coarser grid
    }
}

/// Sizes of several layers, which are taken one or two at a time and end within a block.
constexpr std::array<int, 3> sizes[] = {{150, 141, 130}, {260, 257, 70}, {40, 30, 20}};

template <class Voxel>
Volume shells(const std::array<int, 3>& size, double z_spacing = 1) {
    Volume volume = testing::sampled<Voxel>(
        size, [&](double x, double y, double z) { return testing::shells(x, y, z * z_spacing, size[0]); });
    volume.geometry.spacing_mm = {1, 1, z_spacing};
    return volume;
}

TEST(SpaoLayers, AreTheWhole) {
    const Device device = Device::cpu(2);
    for (const auto& size : sizes) {
        const Medium sparse = classify(upload(device, shells<std::uint16_t>(size)), testing::two_materials(), {});
        for (const int levels : {1, 2, 3, 4, 7})
            expect_same(sparse, {.levels = levels}, "sparse " + std::to_string(size[0]));
        expect_same(sparse, {.levels = 5, .normal_factor = 0, .model = SpaoModel::thick}, "thick");
        const Medium fog = classify(upload(device, shells<std::uint8_t>(size)), testing::constant(0.02), {});
        expect_same(fog, {}, "fog " + std::to_string(size[0]));
    }
}

TEST(SpaoLayers, AreTheWholeBetweenVoxelsOfSurfacesAndWhereCut) {
    const Device device = Device::cpu(2);
    const DeviceVolume thick_slices = upload(device, shells<float>({140, 150, 60}, 2.3));
    expect_same(classify(thick_slices, testing::two_materials(), {}), {}, "thick slices");
    Shape surfaces, cut;
    surfaces.mode = Mode::iso, surfaces.iso = {{100}};
    cut.clip.box = {0.1, 1, 0, 0.7, 0.3, 0.8};
    const DeviceVolume cubes = upload(device, shells<std::uint8_t>(sizes[0]));
    expect_same(classify(cubes, testing::two_materials(), surfaces), {}, "surfaces");
    expect_same(classify(cubes, testing::two_materials(), cut), {}, "cut");
}

TEST(SpaoLayers, CanBeCancelled) {
    const Device device = Device::cpu(2);
    const Medium medium = classify(upload(device, shells<std::uint8_t>(sizes[0])), testing::two_materials(), {});
    StageTimer timer;
    Progress progress;
    progress.cancel();
    EXPECT_THROW(spao_light(device, medium.data(), {}, timer, progress), Error);
}

}  // namespace
}  // namespace chiaro

// Opacities of cells: rows of them against one after the other.
#include <gtest/gtest.h>

#include <random>

#include "fixtures.h"
#include "illumination/cells/classifier.h"
#include "volume/splined.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// A ball with noise on it, whose voxels are so far apart along z.
template <class T>
Volume noisy_ball(double spacing_z) {
    std::mt19937 random(3);
    Volume volume = sampled<T>({75, 40, 37}, [&](double x, double y, double z) {
        const double r = std::hypot(x - 30, y - 20, (z - 18) * spacing_z);
        return 200 / (1 + std::exp((r - 14) / 1.5)) + double(random() % 12);
    });
    volume.geometry.spacing_mm = {1, 1, spacing_z};
    return volume;
}

Shape surfaces() {
    Shape shape;
    shape.mode = Mode::iso;
    shape.iso = {{.value = 100, .color = Rgb{1, 1, 1}}, {.value = 150, .color = Rgb{1, 1, 1}, .opacity = 0.5}};
    return shape;
}

TransferFunction soft() {
    TransferFunction tf = constant(0.9);
    tf.points = {{40, {1, 1, 1}, 0}, {180, {1, 1, 1}, 0.9}};
    return tf;
}

/// Each cell's own opacity, found alone.
template <class Voxel>
std::vector<std::uint16_t> one_by_one(const Medium::Data& medium) {
    const OpacityMaps maps = opacity_maps(medium);
    const auto entries = opacity_entries(medium, maps.grid);
    const auto kernel = opacity_kernel<Voxel>(medium, maps.grid, entries);
    std::vector<std::uint16_t> found;
    for (int z = 0; z < maps.grid.count[2]; ++z)
        for (int y = 0; y < maps.grid.count[1]; ++y)
            for (int x = 0; x < maps.grid.count[0]; ++x) {
                const std::size_t block = maps.matter.index(x / block_edge, y / block_edge, z / block_edge);
                found.push_back(maps.matter.holds[block] ? kernel.unclipped(x, y, z, maps.visible.holds[block]) : 0);
            }
    return found;
}

template <class T>
void expect_rows_as_cells(double spacing_z, bool is_spline, const Shape& shape) {
    for (const Isa isa : available_isas()) {
        const DeviceVolume voxels = upload(Device::cpu(2, isa), noisy_ball<T>(spacing_z));
        const Medium medium = classify(is_spline ? splined(voxels, true) : voxels, soft(), shape);
        Progress progress;
        const CellOpacity opacity = cell_opacity(medium.data(), progress);
        const std::uint16_t* cells = opacity.values.data();
        const auto expected = with_stored_voxel(medium.data().volume.data(),
                                                [&](auto zero) { return one_by_one<decltype(zero)>(medium.data()); });
        ASSERT_EQ(expected.size(), opacity.values.grid.size());
        std::size_t different = 0, in_part = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            different += cells[i] != expected[i];
            in_part += cells[i] > 0 && cells[i] < 65535;
        }
        EXPECT_EQ(different, 0u) << spacing_z << " " << is_spline << " " << int(isa);
        EXPECT_GT(in_part, 500u);
    }
}

}  // namespace

// Cubes, cells between voxels, and slices so thick that normals show them.
TEST(CellOpacity, OfRowsIsThatOfEachCell) {
    for (const double spacing_z : {1.0, 1.3, 1.9})
        for (const bool is_spline : {false, true})
            for (const Shape& shape : {Shape{}, surfaces()}) {
                expect_rows_as_cells<std::uint8_t>(spacing_z, is_spline, shape);
                expect_rows_as_cells<std::int16_t>(spacing_z, is_spline, shape);
                expect_rows_as_cells<float>(spacing_z, is_spline, shape);
            }
}

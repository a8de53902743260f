// The optical table and the occupancy cubes against their definitions.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "classify/medium.h"
#include "classify/segments.h"
#include "fixtures.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

const OpticalTable::Entry& entry_at(const Medium& medium, double value) {
    const auto& d = medium.data();
    const auto& v = d.volume.data();
    return d.table.entries.at(std::size_t(std::lround(d.table.index_of((value - v.offset) / v.scale))));
}

DeviceVolume ramp() {
    return upload(tested_device(), sampled<std::uint8_t>({256, 2, 2}, [](double x, double, double) { return x; }));
}

}  // namespace

TEST(OpticalTable, HoldsTheExtinctionOfEveryStoredValue) {
    const DeviceVolume volume = ramp();
    const Medium medium = classify(volume, two_materials(), {});
    for (int value = 60; value <= 220; ++value) {
        const double opacity = evaluate(two_materials(), value).opacity;
        EXPECT_NEAR(entry_at(medium, value).extinction_per_mm, -std::log1p(-opacity), 1e-5) << value;
    }
    EXPECT_EQ(medium.data().table.entries.front().extinction_per_mm, 0);
}

TEST(OpticalTable, OpacityBelongsToItsUnit) {
    Volume thick = sampled<std::uint8_t>({4, 4, 4}, [](double x, double, double) { return 80 * x; });
    thick.geometry.spacing_mm = {2, 3, 4};
    const DeviceVolume volume = upload(tested_device(), thick);
    TransferFunction tf = constant(0.5);
    EXPECT_NEAR(entry_at(classify(volume, tf, {}), 100).extinction_per_mm, std::log(2) / 2, 1e-6);  // a voxel is 2 mm
    tf.opacity_unit = 5;
    EXPECT_NEAR(entry_at(classify(volume, tf, {}), 100).extinction_per_mm, std::log(2) / 10, 1e-6);
    tf.opacity_unit_is_mm = true;
    EXPECT_NEAR(entry_at(classify(volume, tf, {}), 100).extinction_per_mm, std::log(2) / 5, 1e-6);
    EXPECT_NEAR(entry_at(classify(volume, tf, {.opacity_scale = 3}), 100).extinction_per_mm, 3 * std::log(2) / 5, 1e-6);
    EXPECT_TRUE(std::isfinite(entry_at(classify(volume, constant(1), {}), 100).extinction_per_mm));
}

TEST(OpticalTable, ThresholdCutsValuesOff) {
    const Medium medium = classify(ramp(), constant(0.5), {.threshold_low = 50, .threshold_high = 100});
    EXPECT_EQ(entry_at(medium, 49).extinction_per_mm, 0);
    EXPECT_GT(entry_at(medium, 50).extinction_per_mm, 0);
    EXPECT_GT(entry_at(medium, 100).extinction_per_mm, 0);
    EXPECT_EQ(entry_at(medium, 101).extinction_per_mm, 0);
}

TEST(OpticalTable, ColoursAreDecodedForLinearLightOnly) {
    TransferFunction tf = constant(0.5, {0.5, 0.5, 0.5});
    tf.rgb_space = RgbSpace::srgb;
    EXPECT_NEAR(entry_at(classify(ramp(), tf, {}), 9).r, 0.2140, 1e-4);  // IEC 61966-2-1
    EXPECT_NEAR(entry_at(classify(ramp(), tf, {.color = ColorMode::display}), 9).r, 0.5, 1e-6);
}

namespace {

/// ∫ c κ exp(-∫ κ) along a step from one node to another, in ten thousand pieces.
std::array<double, 4> integral(const OpticalTable& table, double near_entry, double far_entry, double step_mm) {
    std::array<double, 4> sum{};
    double transmittance = 1;
    constexpr int pieces = 10000;
    for (int i = 0; i < pieces; ++i) {
        const double entry = near_entry + (i + 0.5) / pieces * (far_entry - near_entry);
        const auto& e = table.entries[std::size_t(std::clamp(entry + 0.5, 0.0, double(table.entries.size()) - 1))];
        const double alpha = -std::expm1(-double(e.extinction_per_mm) * step_mm / pieces);
        const double weight = transmittance * alpha;
        sum[0] += weight * e.r, sum[1] += weight * e.g, sum[2] += weight * e.b, sum[3] += weight;
        transmittance *= 1 - alpha;
    }
    return sum;
}

}  // namespace

template <class T>
void expect_integrals(double scale) {
    std::mt19937 random(7);
    const DeviceVolume volume =
        upload(tested_device(), sampled<T>({256, 2, 2}, [&](double x, double, double) { return scale * x; }));
    TransferFunction tf = two_materials();
    for (auto& point : tf.points) point.value *= scale;
    const Medium medium = classify(volume, tf, {});
    const OpticalTable& optical = medium.data().table;
    for (double step_mm : {0.25, 1.0, 4.0}) {
        const SegmentTable table = make_segment_table(volume.data(), optical, step_mm, 2);
        EXPECT_GE(table.nodes, 256);
        const auto entry = [&](int node) { return optical.index_of((node - table.offset) / table.scale); };
        for (int i = 0; i < 200; ++i) {
            const int near = int(random() % unsigned(table.nodes)), far = int(random() % unsigned(table.nodes));
            const auto expected = integral(optical, entry(near), entry(far), step_mm);
            const kernel::Rgba& c = table.entries[std::size_t(near) * table.nodes + far];
            EXPECT_NEAR(c.r, expected[0], 2e-3) << near << " " << far;
            EXPECT_NEAR(c.g, expected[1], 2e-3) << near << " " << far;
            EXPECT_NEAR(c.b, expected[2], 2e-3) << near << " " << far;
            EXPECT_NEAR(c.a, expected[3], 1e-3) << near << " " << far;
        }
    }
}
TEST(SegmentTable, HoldsIntegralsOfBytes) { expect_integrals<std::uint8_t>(1); }
TEST(SegmentTable, HoldsIntegralsOfShorts) { expect_integrals<std::uint16_t>(200); }
TEST(SegmentTable, HoldsIntegralsOfFloats) { expect_integrals<float>(0.01); }

// The radius of every cell's cube is its Chebyshev distance to the nearest cell of the other kind, less one.
TEST(Occupancy, CubesAreAsLargeAsTheyCanBe) {
    std::mt19937 random(3);
    const std::array<int, 3> n{45, 61, 38};
    Volume volume = make_volume(n, VoxelType::u8);
    for (int i = 0; i < 25; ++i) volume.as<std::uint8_t>()[random() % volume.voxel_count()] = 200;
    const DeviceVolume device_volume = upload(tested_device(), volume);
    const Medium medium = classify(device_volume, two_materials(), {});
    const auto count = device_volume.data().cells.count;
    const auto code = [&](int x, int y, int z) {
        return medium.data().cells[(std::size_t(z) * count[1] + y) * count[0] + x];
    };
    int occupied = 0;
    for (int z = 0; z < count[2]; ++z)
        for (int y = 0; y < count[1]; ++y)
            for (int x = 0; x < count[0]; ++x) {
                int nearest = 126;
                for (int c = 0; c < count[2]; ++c)
                    for (int b = 0; b < count[1]; ++b)
                        for (int a = 0; a < count[0]; ++a)
                            if ((code(a, b, c) & 1) != (code(x, y, z) & 1))
                                nearest =
                                    std::min(nearest, std::max({std::abs(a - x), std::abs(b - y), std::abs(c - z)}));
                ASSERT_EQ(code(x, y, z) >> 1, nearest - 1) << x << " " << y << " " << z;
                const bool visible =
                    device_volume.data().cells.high[(std::size_t(z) * count[1] + y) * count[0] + x] > 0;
                ASSERT_EQ(code(x, y, z) & 1, visible);
                occupied += visible;
            }
    EXPECT_NEAR(medium.occupied_fraction(), double(occupied) / (count[0] * count[1] * count[2]), 1e-12);
    EXPECT_GT(occupied, 20);
}

TEST(Occupancy, AnEmptyVolumeIsOneCube) {
    const Medium medium = classify(ramp(), constant(0), {});
    EXPECT_EQ(medium.occupied_fraction(), 0);
    EXPECT_EQ(medium.data().cells.front(), 2 * 125);
}

// Bricks that show something stay as they are, the others lose what whole pages hold; where zeros would show, all
// stays.
TEST(Unseen, OnlyBricksThatShowNothingAreGivenBack) {
    const auto make = [](const TransferFunction& tf, const Shape& shape, int matter = 110) {
        // Values of 30 are empty, in the corner at the origin there is matter.
        const Volume volume = sampled<std::uint8_t>(
            {100, 70, 65}, [&](double x, double y, double z) { return x + y + z < 20 ? matter : 30; });
        return classify(upload(tested_device(), volume), tf, shape);
    };
    const auto zeros = [](const Medium& medium, std::size_t first_brick, std::size_t end_brick) {
        const std::byte* bricks = medium.data().volume.data().bricks.data();
        return std::count(bricks + first_brick * brick_voxels, bricks + end_brick * brick_voxels, std::byte(0));
    };
    const std::size_t bricks = 4 * 3 * 2;
    const Medium medium = make(two_materials(), {});
    ASSERT_EQ(zeros(medium, 0, bricks), 0);
    discard_unseen(medium);
    EXPECT_EQ(zeros(medium, 0, 1), 0);
    EXPECT_GT(zeros(medium, 1, bricks), 0.9 * double((bricks - 1) * brick_voxels));

    for (const Shape& shape : {Shape{.mode = Mode::mip}, Shape{.mode = Mode::iso, .iso = {{.value = 60}}}}) {
        const Medium whole = make(two_materials(), shape);
        discard_unseen(whole);
        EXPECT_EQ(zeros(whole, 0, bricks), 0);
    }
    // Opaque below 10.
    TransferFunction shows_zero = two_materials();
    shows_zero.points.insert(shows_zero.points.begin(), {{0, {1, 1, 1}, 1}, {10, {1, 1, 1}, 0}});
    const Medium whole = make(shows_zero, {}, 5);
    discard_unseen(whole);
    EXPECT_EQ(zeros(whole, 0, bricks), 0);
}

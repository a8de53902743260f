// Bricks, sampling and gradients against the voxels they came from.
#include "volume/device_volume.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "fixtures.h"
#include "volume/device_view.h"
#include "volume/every_other.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

template <class Voxel>
kernel::VolumeView<Voxel> view_of(const DeviceVolume& volume) {
    return chiaro::view_of<Voxel>(volume.data());
}

template <class Voxel>
float value_at(const kernel::VolumeView<Voxel>& view, kernel::Vec3<float> p) {
    p = view.clamp(p);
    return view.value(view.locate(p, view.voxel(p)));
}

// Trilinear in x, y and z; what trilinear interpolation reproduces exactly.
double multilinear(double x, double y, double z) {
    return 3 + 0.5 * x - 0.25 * y + z + 0.125 * x * y - 0.0625 * y * z + 0.03125 * x * y * z;
}

}  // namespace

TEST(Sampling, ReproducesXyzExactlyAcrossBricks) {
    const Volume volume = sampled<float>({70, 41, 37}, multilinear);
    const DeviceVolume device_volume = upload(tested_device(), volume);
    const auto view = view_of<float>(device_volume);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> u(0, 1);
    for (int i = 0; i < 20000; ++i) {
        const float x = 69 * u(random), y = 40 * u(random), z = 36 * u(random);
        const double expected = multilinear(x, y, z);
        ASSERT_NEAR(value_at(view, {x, y, z}), expected, 2e-6 * (std::abs(expected) + 700))
            << x << " " << y << " " << z;
        const auto p = view.clamp(kernel::Vec3<float>{x, y, z});
        const auto at = view.locate(p, view.voxel(p));
        float value;
        const auto g = view.differences(at, value);
        ASSERT_EQ(value, view.value(at));
        if (x < 1 || x > 68 || y < 1 || y > 39 || z < 1 || z > 35) continue;
        ASSERT_NEAR(g.x, 0.5 + 0.125 * y + 0.03125 * y * z, 2e-3);
        ASSERT_NEAR(g.y, -0.25 + 0.125 * x - 0.0625 * z + 0.03125 * x * z, 2e-3);
        ASSERT_NEAR(g.z, 1 - 0.0625 * y + 0.03125 * x * y, 2e-3);
    }
}

TEST(Sampling, GradientsAtTheBorderUseTheBorderVoxelItself) {
    const DeviceVolume volume =
        upload(tested_device(), sampled<float>({5, 5, 5}, [](double x, double, double) { return 2 * x; }));
    const auto view = view_of<float>(volume);
    const kernel::Vec3<float> p{0, 2, 2};
    EXPECT_FLOAT_EQ(view.gradient(view.locate(p, view.voxel(p))).x, 1);  // (f(1) - f(0)) / 2
}

template <class T>
class StoredTypes : public ::testing::Test {};
using AllTypes = ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t,
                                  std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(StoredTypes, AllTypes);

// Every type keeps its values through scale and offset, and every cell its exact range.
TYPED_TEST(StoredTypes, ValuesAndCellRangesSurviveBricking) {
    std::mt19937 random(7);
    const std::array<int, 3> n{67, 33, 34};
    Volume volume = sampled<TypeParam>(n, [&](double, double, double) { return int(random() % 120); });
    volume.slope = 0.5;
    volume.intercept = -20;
    const DeviceVolume device_volume = upload(tested_device(), volume);
    const auto& d = device_volume.data();
    const auto stored = [&](int x, int y, int z) -> double {
        const kernel::Vec3<float> p{float(x), float(y), float(z)};
        switch (d.stored) {
            case VoxelType::u8:
                return value_at(view_of<std::uint8_t>(device_volume), p);
            case VoxelType::u16:
                return value_at(view_of<std::uint16_t>(device_volume), p);
            default:
                return value_at(view_of<float>(device_volume), p);
        }
    };
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x)
                ASSERT_NEAR(d.scale * stored(x, y, z) + d.offset,
                            0.5 * double(volume.as<TypeParam>()[(std::size_t(z) * n[1] + y) * n[0] + x]) - 20, 1e-4);
    for (int cz = 0; cz < d.cells.count[2]; ++cz)
        for (int cy = 0; cy < d.cells.count[1]; ++cy)
            for (int cx = 0; cx < d.cells.count[0]; ++cx) {
                double low = 1e9, high = -1e9;
                for (int z = cz * cell_edge; z <= std::min((cz + 1) * cell_edge, n[2] - 1); ++z)
                    for (int y = cy * cell_edge; y <= std::min((cy + 1) * cell_edge, n[1] - 1); ++y)
                        for (int x = cx * cell_edge; x <= std::min((cx + 1) * cell_edge, n[0] - 1); ++x)
                            low = std::min(low, stored(x, y, z)), high = std::max(high, stored(x, y, z));
                const std::size_t cell = (std::size_t(cz) * d.cells.count[1] + cy) * d.cells.count[0] + cx;
                ASSERT_EQ(d.cells.low[cell], float(low));
                ASSERT_EQ(d.cells.high[cell], float(high));
            }
}

/// Values that are far from 0 beside their range keep what tells them apart: pressure in Pa, times, large numbers.
template <class T>
double largest_error_of(double offset, double range) {
    std::mt19937 random(3);
    const std::array<int, 3> n{9, 8, 7};
    const Volume volume =
        sampled<T>(n, [&](double, double, double) { return offset + range * (random() % 1000) / 999; });
    const DeviceVolume uploaded = upload(tested_device(), volume);
    double largest = 0;
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x) {
                const double stored =
                    value_at(view_of<float>(uploaded), kernel::Vec3<float>{float(x), float(y), float(z)});
                const T given = volume.as<T>()[(std::size_t(z) * n[1] + y) * n[0] + x];
                largest = std::max(largest, std::abs(uploaded.data().value_of(stored) - double(given)));
            }
    return largest;
}

TEST(Upload, KeepsValuesFarFromZeroApart) {
    EXPECT_LT(largest_error_of<double>(1e9, 1), 2e-7);
    EXPECT_LT(largest_error_of<double>(-101325, 0.1), 2e-8);
    EXPECT_EQ(largest_error_of<float>(101325, 100), 0);
    EXPECT_EQ(largest_error_of<std::int64_t>(1e12, 1e6), 0);
    EXPECT_LT(largest_error_of<double>(5, 10), 1e-6);
}

TEST(Upload, KeepsBytesAndShortsAndNarrowsWideIntegers) {
    const auto stored = [](auto zero, double top) {
        using T = decltype(zero);
        return upload(tested_device(), sampled<T>({4, 4, 4}, [&](double x, double, double) { return x / 3 * top; }))
            .data()
            .stored;
    };
    EXPECT_EQ(stored(std::uint8_t{}, 255), VoxelType::u8);
    EXPECT_EQ(stored(std::int8_t{}, 100), VoxelType::u8);
    EXPECT_EQ(stored(std::int16_t{}, 3000), VoxelType::u16);
    EXPECT_EQ(stored(std::int32_t{}, 60000), VoxelType::u16);
    EXPECT_EQ(stored(std::int32_t{}, 70000), VoxelType::f32);
    EXPECT_EQ(stored(double{}, 1), VoxelType::f32);
}

TEST(Upload, ReplacesWhatIsNotFinite) {
    Volume volume = sampled<float>({3, 1, 1}, [](double, double, double) { return 5; });
    auto v = volume.as<float>();
    v[0] = NAN, v[2] = INFINITY;
    const DeviceVolume device_volume = upload(tested_device(), volume);
    EXPECT_EQ(device_volume.data().stored_min, 5);
    EXPECT_EQ(device_volume.data().stored_max, 5);
    v[1] = -INFINITY;
    EXPECT_THROW(upload(tested_device(), volume), Error);
}

TEST(Upload, TakesTheVolumeApartWithoutChangingTheBricks) {
    const auto make = [] {
        return sampled<std::uint16_t>({130, 70, 90},
                                      [](double x, double y, double z) { return 3 * x + 5 * y + 7 * z; });
    };
    const DeviceVolume kept = upload(tested_device(), make());
    const Volume whole = make();
    const DeviceVolume copied = upload(tested_device(), whole);
    ASSERT_EQ(kept.data().bricks.size(), copied.data().bricks.size());
    EXPECT_EQ(std::memcmp(kept.data().bricks.data(), copied.data().bricks.data(), kept.data().bricks.size()), 0);
}

TEST(Upload, LeavesNothingOfTheVolumeWhoseMemoryItTakes) {
    const auto number = [](double x, double y, double z) { return 3 * x + 5 * y + 7 * z; };
    const auto make = [](auto value) { return upload(tested_device(), sampled<std::uint16_t>({130, 70, 90}, value)); };
    const DeviceVolume first = make(number);
    make([](double, double, double) { return 65535; });
    const DeviceVolume second = make(number);
    ASSERT_TRUE(second.data().bricks.is_borrowed());
    EXPECT_EQ(std::memcmp(first.data().bricks.data(), second.data().bricks.data(), first.data().bricks.size()), 0);
}

TEST(EveryOtherVoxel, IsTheUploadOfEveryOtherVoxel) {
    const auto value = [](double x, double y, double z) { return 3 * x + 5 * y + 7 * z; };
    const auto check = [&]<class T>(T) {
        Progress progress;
        const DeviceVolume half = every_other_voxel(upload(tested_device(), sampled<T>({71, 66, 35}, value)), progress);
        const DeviceVolume expected =
            upload(tested_device(),
                   sampled<T>({36, 33, 18}, [&](double x, double y, double z) { return value(2 * x, 2 * y, 2 * z); }));
        EXPECT_EQ(half.dimensions(), expected.dimensions());
        EXPECT_EQ(half.geometry().spacing_mm.x, 2 * expected.geometry().spacing_mm.x);
        const DeviceVolume::Data &a = half.data(), &b = expected.data();
        ASSERT_EQ(a.bricks.size(), b.bricks.size());
        EXPECT_EQ(a.stored, b.stored);
        EXPECT_EQ(std::memcmp(a.bricks.data(), b.bricks.data(), a.bricks.size()), 0);
        EXPECT_EQ(a.cells.low, b.cells.low);
        EXPECT_EQ(a.cells.high, b.cells.high);
        EXPECT_EQ(a.value_of(3), b.value_of(3));
        EXPECT_EQ(a.stored_max, T(value(70, 65, 34))) << "as of the volume";
    };
    check(std::uint16_t()), check(float());
}

TEST(Upload, RefusesColourVolumes) {
    Volume volume = make_volume({4, 4, 4}, VoxelType::u8);
    volume.components = 3;
    EXPECT_THROW(upload(tested_device(), volume), Error);
}

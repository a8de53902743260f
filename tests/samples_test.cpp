// The samples against their definitions, at several sizes.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "core/did_you_mean.h"

using namespace chiaro;

namespace {

template <class T>
T voxel(const Volume& v, int i, int j, int k) {
    return v.as<T>()[(std::size_t(k) * v.dimensions[1] + j) * v.dimensions[0] + i];
}

std::uint32_t checksum(const Volume& v) {
    return std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(v.voxels.data()), uInt(v.voxels.size())));
}

}  // namespace

TEST(Samples, EveryOneHasItsDefaultsAtAnySize) {
    ASSERT_EQ(list_samples().size(), 11u);
    for (const SampleInfo& info : list_samples())
        for (int size : {2, 33, 48}) {
            const Volume v = make_sample(info.name, size);
            EXPECT_EQ(v.dimensions, (std::array<int, 3>{size, size, size}));
            EXPECT_EQ(v.voxels.size(), v.voxel_count() * size_of(v.type));
            EXPECT_EQ(v.source, "sample:" + info.name);
            EXPECT_NO_THROW(validate(sample_transfer_function(info.name))) << info.name;
        }
    EXPECT_EQ(make_sample("cornell").dimensions[0], 128);
    EXPECT_EQ(make_sample("cornell").type, VoxelType::u8);
}

TEST(Samples, RefusesUnknownNamesAndSizes) {
    try {
        make_sample("cornel");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        EXPECT_STREQ(error.what(), "unknown sample 'cornel'; did you mean 'cornell'?");
    }
    for (int size : {-1, 1, 4097}) EXPECT_THROW(make_sample("ball", size), Error) << size;
    EXPECT_THROW(sample_transfer_function("nothing like it"), Error);
}

TEST(Samples, CornellIsAsSpecified) {
    const Volume v = make_sample("cornell", 128);
    const auto at = [&](int i, int j, int k) { return int(voxel<std::uint8_t>(v, i, j, k)); };
    for (int t : {0, 1, 2}) {  // walls 3 voxels thick
        EXPECT_EQ(at(t, 64, 64), 80);
        EXPECT_EQ(at(127 - t, 64, 64), 120);
        EXPECT_EQ(at(64, 127 - t, 64), 40);
        EXPECT_EQ(at(64, 64, t), 40);
        EXPECT_EQ(at(64, 64, 127 - t), 40);
        EXPECT_EQ(at(64, t, 100), 0);  // open towards -y
    }
    EXPECT_EQ(at(3, 64, 100), 0);
    EXPECT_EQ(at(64, 124, 100), 0);
    EXPECT_EQ(at(43, 82, 20), 160);  // box
    EXPECT_EQ(at(43, 82, 3), 160);   // on the floor
    EXPECT_EQ(at(87, 46, 24), 200);  // sphere
    EXPECT_EQ(at(87, 46, 4), 200);   // on the floor
    for (std::uint8_t value : v.as<std::uint8_t>())
        ASSERT_TRUE(value <= 200 && value % 40 == 0) << int(value);  // one of the six materials
}

TEST(Samples, CornellScales) {  // doubling the size keeps what lies at a position
    const Volume small = make_sample("cornell", 64), large = make_sample("cornell", 192);
    for (int k = 0; k < 64; ++k)
        for (int j = 0; j < 64; ++j)
            for (int i = 0; i < 64; ++i)  // voxel centres of `small` are among those of `large`
                ASSERT_EQ(voxel<std::uint8_t>(small, i, j, k),
                          voxel<std::uint8_t>(large, 3 * i + 1, 3 * j + 1, 3 * k + 1));
}

TEST(Samples, CornellTransferFunctionIsBoxes) {
    const TransferFunction tf = sample_transfer_function("cornell");
    EXPECT_EQ(tf.opacity_unit, 1);
    EXPECT_FALSE(tf.opacity_unit_is_mm);
    for (double value : {40, 80, 120, 160, 200})
        for (double offset : {-14.9, 0.0, 14.9}) EXPECT_EQ(evaluate(tf, value + offset).opacity, 1) << value + offset;
    for (double value : {0, 24, 60, 100, 140, 180, 216, 255}) EXPECT_EQ(evaluate(tf, value).opacity, 0) << value;
}

namespace {

/// The shells once more, term by term as they are documented.
int shells_by_formula(int i, int j, int k, int n) {
    const double x = 2.0 * i / (n - 1) - 1, y = 2.0 * j / (n - 1) - 1, z = 2.0 * k / (n - 1) - 1;
    const double w = 0.035 * std::sin(9 * x) * std::sin(8 * y) * std::sin(7 * z) +
                     0.01 * std::sin(31 * x + 3) * std::sin(29 * y + 1) * std::sin(27 * z + 2);
    const double r = std::sqrt(x * x + y * y + z * z);
    double v = 8;
    const double shells[3][3] = {{235, 0.28, 0.05}, {170, 0.55, 0.04}, {100, 0.82, 0.04}};
    for (const auto& [height, radius, width] : shells)
        v = std::fmax(v, height * std::exp(-std::pow((r + w - radius) / width, 2)));
    std::uint32_t h = std::uint32_t(i) * 2654435761u ^ (std::uint32_t(j) * 2246822519u + 2135587861u) ^
                      (std::uint32_t(k) * 3266489917u + 374761393u);
    for (const auto& [shift, factor] : {std::pair{16, 2146121005u}, std::pair{15, 2221713035u}})
        h = (h ^ h >> shift) * factor;
    h ^= h >> 16;
    return int(std::fmin(255, std::fmax(0, std::floor(v + (h / 4294967296.0 * 12 - 6) + 0.5))));
}

}  // namespace

TEST(Samples, ShellsAreTheBenchmarksVolume) {
    const Volume v = make_sample("shells", 256);
    EXPECT_EQ(v.type, VoxelType::u8);
    EXPECT_EQ(checksum(v), 0x0b857202u);  // crc32 of the file that the peer benchmark's generator writes
    for (int k = 0; k < 256; k += 7)
        for (int j = 0; j < 256; j += 5)
            for (int i = 0; i < 256; i += 3)
                ASSERT_EQ(voxel<std::uint8_t>(v, i, j, k), shells_by_formula(i, j, k, 256));
}

TEST(Samples, ShellsKeepTheirTypeAtOddSizes) {
    const Volume v = make_sample("shells", 37);
    for (int k = 0; k < 37; ++k)
        for (int j = 0; j < 37; ++j) ASSERT_EQ(voxel<std::uint8_t>(v, 11, j, k), shells_by_formula(11, j, k, 37));
}

TEST(Samples, MarschnerLobb) {
    const Volume v = make_sample("marschner-lobb", 41);
    EXPECT_NEAR(voxel<float>(v, 20, 20, 20), (1 + 0.25 * 2) / 2.5, 1e-6);  // origin: ρ(0) = cos 12π = 1
    EXPECT_NEAR(voxel<float>(v, 20, 20, 40), 0.25 * 2 / 2.5, 1e-6);        // z = 1
    EXPECT_NEAR(voxel<float>(v, 40, 20, 0), (2 + 0.25 * 2) / 2.5, 1e-6);   // r = 1: cos 0 = 1, z = -1
    EXPECT_NEAR(voxel<float>(v, 33, 14, 27), voxel<float>(v, 14, 33, 27), 1e-6);
}

TEST(Samples, FogIsSmoothAndLeavesTheBordersFree) {
    const Volume v = make_sample("fog", 96);
    float highest = 0, steepest = 0;
    for (int k = 0; k < 96; ++k)
        for (int j = 0; j < 96; ++j)
            for (int i = 1; i < 96; ++i) {
                const float value = voxel<float>(v, i, j, k);
                ASSERT_TRUE(value >= 0 && value <= 1);
                highest = std::max(highest, value);
                steepest = std::max(steepest, std::abs(value - voxel<float>(v, i - 1, j, k)));
            }
    EXPECT_GT(highest, 0.8f);
    EXPECT_LT(steepest, 0.2f);
    EXPECT_EQ(voxel<float>(v, 0, 48, 48), 0);
}

TEST(Samples, BodiesOfOneValue) {
    const Volume slab = make_sample("slab", 64), half = make_sample("halfspace", 64), ball = make_sample("ball", 64);
    for (int k = 0; k < 64; ++k) {
        EXPECT_EQ(voxel<std::uint8_t>(slab, 5, 40, k), k >= 16 && k < 48 ? 200 : 0) << k;
        EXPECT_EQ(voxel<std::uint8_t>(half, 5, 40, k), k < 32 ? 200 : 0) << k;
    }
    double volume = 0;
    for (std::uint8_t value : ball.as<std::uint8_t>()) volume += value / 200.0;
    EXPECT_NEAR(volume, 4.0 / 3 * M_PI * std::pow(24, 3), 0.002 * volume);
    EXPECT_EQ(voxel<std::uint8_t>(ball, 32, 32, 32), 200);
    EXPECT_EQ(voxel<std::uint8_t>(ball, 2, 32, 32), 0);
}

TEST(Samples, TubesHoldFiveMaterials) {
    const Volume v = make_sample("tubes", 128);
    const auto at = [&](double x, double y, double z) {
        return int(voxel<std::uint8_t>(v, int(128 * x), int(128 * y), int(128 * z)));
    };
    EXPECT_EQ(at(0.5, 0.9, 0.08), 0);            // plate
    EXPECT_EQ(at(0.5, 0.42, 0.30), 128);         // inside of the tube: hollow
    EXPECT_EQ(at(0.5, 0.42, 0.30 + 0.172), 40);  // its wall
    EXPECT_EQ(at(0.80, 0.56, 0.55), 255);        // ball
    EXPECT_EQ(at(0.4, 0.76, 0.50), 227);         // bar
    EXPECT_EQ(at(0.815, 0.3, 0.3), 200);         // pane
}

TEST(Samples, MengerKeepsTwentyOfTwentySevenAtEachLevel) {
    for (int size : {83, 166}) {
        const Volume v = make_sample("menger", size);
        std::size_t solid = 0;
        for (std::uint8_t value : v.as<std::uint8_t>()) solid += value == 255;
        EXPECT_EQ(solid, 160000u * (size / 83) * (size / 83) * (size / 83));  // 20⁴ cells
    }
}

TEST(DidYouMean, CountsEdits) {
    EXPECT_EQ(edit_distance("", "abc"), 3);
    EXPECT_EQ(edit_distance("viridis", "viridis"), 0);
    EXPECT_EQ(edit_distance("virdiis", "viridis"), 1);  // a swap of neighbours
    EXPECT_EQ(edit_distance("Kitten", "sitting"), 3);
    const std::vector<std::string> words{"ball", "slab", "halfspace"};
    EXPECT_EQ(nearest_word("hlafspace", words), "halfspace");
    EXPECT_EQ(nearest_word("xyz", words), std::nullopt);
    EXPECT_EQ(did_you_mean("slba", words), "; did you mean 'slab'?");
    EXPECT_EQ(did_you_mean("", words), "");
}

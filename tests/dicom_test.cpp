// DICOM series: order, geometry, rescale, and everything out of the ordinary that must be reported.
#include "volume_files.h"

#include <chiaro/error.h>

#include <cmath>
#include <numbers>

using namespace chiaro;
using namespace volume_files;

namespace {

/// `count` slices 3 mm apart along z, slice i filled with its number; `change` may alter each.
template <class Change>
void write_series(const Folder& folder, int count, Change&& change) {
    for (int i = 0; i < count; ++i) {
        Dicom slice;
        slice.instance = i + 1;
        slice.position = {10, 20, 30 + 3.0 * i};
        slice.pixels = std::vector<std::uint16_t>(12, std::uint16_t(100 * i));
        slice.pixels[1] = std::uint16_t(100 * i + 1);
        change(slice, i);
        folder.write("IM" + std::to_string((i * 7) % count) + ".dcm", slice.bytes());  // names in no order
    }
}

std::vector<int> first_pixels(const Volume& volume) {
    std::vector<int> values;
    for (int z = 0; z < volume.dimensions[2]; ++z) values.push_back(volume.as<std::uint16_t>()[std::size_t(z) * 12]);
    return values;
}

constexpr double degree = std::numbers::pi / 180;

}  // namespace

TEST(Dicom, SortsByPositionAndKeepsStoredValues) {
    const Folder folder;
    write_series(folder, 5, [](Dicom& slice, int i) { slice.instance = 5 - i; });
    const auto volume = read(folder.name());
    EXPECT_EQ(volume.dimensions, (std::array{4, 3, 5}));
    EXPECT_EQ(first_pixels(volume), (std::vector{0, 100, 200, 300, 400}));
    EXPECT_EQ(volume.as<std::uint16_t>()[1], 1);
    EXPECT_EQ(volume.intercept, -1024);
    EXPECT_EQ(volume.modality, "CT");
    EXPECT_EQ(volume.geometry.world, World::lps);
    expect_near(volume.geometry.spacing_mm, {0.5, 2, 3});
    expect_near(volume.geometry.origin_mm, {10, 20, 30});
    EXPECT_TRUE(volume.notes.empty()) << volume.notes[0];
    const auto statistics = measure(volume);
    EXPECT_EQ(statistics.min, -1024);
    EXPECT_EQ(statistics.max, 401 - 1024);
}

TEST(Dicom, ObliqueSlicesKeepTheirPlace) {
    const Folder folder;
    const double c = std::cos(30 * degree), s = std::sin(30 * degree);
    write_series(folder, 4, [&](Dicom& slice, int i) {
        slice.orientation = {c, s, 0, 0, 0, -1};  // normal (-s, c, 0)
        slice.position = {-s * 3 * i, c * 3 * i, 5};
    });
    const auto volume = read(folder.name());
    EXPECT_EQ(first_pixels(volume), (std::vector{0, 100, 200, 300}));
    expect_near(volume.geometry.direction[0], {c, s, 0});
    expect_near(volume.geometry.direction[1], {0, 0, -1});
    expect_near(volume.geometry.direction[2], {-s, c, 0});
    EXPECT_TRUE(volume.notes.empty());
}

TEST(Dicom, TiltedGantryIsShearedExactlyAndReported) {
    const Folder folder;
    write_series(folder, 4, [](Dicom& slice, int i) {
        slice.position = {0, 3.0 * i * std::tan(15 * degree), 3.0 * i};
    });
    const auto volume = read(folder.name());
    EXPECT_TRUE(has_note(volume, "15 degrees"));
    expect_near(volume.geometry.world_from_voxel({0, 0, 3}), {0, 9 * std::tan(15 * degree), 9}, 1e-5);
    expect_near(volume.geometry.direction[1], {0, 1, 0});
}

TEST(Dicom, MissingSlicesAreInterpolatedAndTold) {
    const Folder folder;
    write_series(folder, 5, [](Dicom& slice, int i) { slice.position[2] = i < 3 ? i : i + 2; });
    const auto volume = read(folder.name());
    EXPECT_TRUE(has_note(volume, "2 of 7 slices are missing (4-5)"));
    EXPECT_EQ(first_pixels(volume), (std::vector{0, 100, 200, 233, 267, 300, 400}));
    EXPECT_NEAR(volume.geometry.spacing_mm.z, 1, 1e-9);
}

TEST(Dicom, UnevenAndRepeatedSlicesAreReported) {
    const Folder uneven, twice;
    write_series(uneven, 5, [](Dicom& slice, int i) { slice.position[2] = i < 3 ? i : i + 1.5; });
    const auto shifted = read(uneven.name());
    EXPECT_TRUE(has_note(shifted, "unevenly spaced (1 to 2.5 mm"));
    EXPECT_NEAR(shifted.geometry.spacing_mm.z, 5.5 / 4, 1e-9);
    write_series(twice, 6, [](Dicom& slice, int i) { slice.position[2] = i % 3; });
    const auto repeated = read(twice.name());
    EXPECT_TRUE(has_note(repeated, "3 slices lie at the place of another"));
    EXPECT_EQ(first_pixels(repeated), (std::vector{0, 100, 200}));
}

TEST(Dicom, SlopesThatDifferBecomeFloats) {
    const Folder folder;
    write_series(folder, 3, [](Dicom& slice, int i) {
        slice.slope = i + 1;
        slice.intercept = 0.5;
    });
    const auto volume = read(folder.name());
    EXPECT_EQ(volume.type, VoxelType::f32);
    EXPECT_EQ(volume.slope, 1);
    EXPECT_EQ(volume.as<float>()[12 * 2], 3 * 200 + 0.5F);
    EXPECT_TRUE(has_note(volume, "differ in rescale"));
}

TEST(Dicom, SkipsStrangersAndNamesOtherSeries) {
    const Folder folder;
    write_series(folder, 3, [](Dicom&, int) {});
    Dicom other{.series = "9.9", .pixels = std::vector<std::uint16_t>(12, 7)};
    folder.write("other.dcm", other.bytes());
    folder.write("README.txt", std::string(1000, 'x'));
    folder.write("empty", "");
    const auto volume = read(folder.name());
    EXPECT_EQ(volume.dimensions[2], 3);
    EXPECT_TRUE(has_note(volume, "2 files that are no readable images were skipped"));
    EXPECT_TRUE(has_note(volume, "9.9"));
    for (const std::string choice : {"2", "9.9"})
        EXPECT_EQ(first_pixels(read(folder.name(), {.raw = {}, .series = choice, .rescale = {}})), std::vector{7});
    EXPECT_THROW(read(folder.name(), {.raw = {}, .series = "3", .rescale = {}}), Error);
}

TEST(Dicom, SignedPixels) {
    const Folder folder;
    Dicom slice{.is_signed = true, .pixels = std::vector<std::uint16_t>(12, std::uint16_t(-5))};
    const auto volume = read(folder.write("one.dcm", slice.bytes()));
    EXPECT_EQ(volume.as<std::int16_t>()[11], -5);
    EXPECT_EQ(volume.dimensions, (std::array{4, 3, 1}));
}

TEST(Dicom, FramesOfAnEnhancedImageAreSlices) {
    const Folder folder;
    std::vector<std::string> frames;
    for (const std::string z : {"6", "3", "0"}) {  // stored from the top down
        const auto position = Dicom::element(0x20, 0x32, "DS", "1\\2\\" + z);
        frames.push_back(Dicom::sequence(0x20, 0x9113, {position}));
    }
    const auto measures = Dicom::sequence(0x28, 0x9110, {Dicom::element(0x28, 0x30, "DS", "0.7\\0.8")});
    const auto orientation = Dicom::sequence(0x20, 0x9116, {Dicom::element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0")});
    Dicom image{.pixels = ramp<std::uint16_t>(36), .frames = 3};
    image.functional_groups =
        Dicom::sequence(0x5200, 0x9229, {orientation + measures}) + Dicom::sequence(0x5200, 0x9230, frames);
    const auto volume = read(folder.write("enhanced.dcm", image.bytes()));
    EXPECT_EQ(first_pixels(volume), (std::vector{24, 12, 0}));
    expect_near(volume.geometry.spacing_mm, {0.8, 0.7, 3});
    expect_near(volume.geometry.origin_mm, {1, 2, 0});
}

TEST(Dicom, FramesWithOnePlaceFollowTheSpacing) {
    const Folder folder;
    const auto last_element = [](const std::string& element) {  // behind group 0028, as the order of tags demands
        return Dicom{.position = {1, 2, 3},
                     .intercept = 0,
                     .pixels = ramp<std::uint16_t>(36),
                     .frames = 3,
                     .functional_groups = element};
    };
    auto dose = last_element(Dicom::element(0x3004, 0xc, "DS", "0\\2\\4") + Dicom::element(0x3004, 0xe, "DS", "0.5"));
    auto volume = read(folder.write("dose.dcm", dose.bytes()));
    EXPECT_EQ(first_pixels(volume), (std::vector{0, 12, 24}));
    expect_near(volume.geometry.spacing_mm, {0.5, 2, 2});
    expect_near(volume.geometry.origin_mm, {1, 2, 3});
    const auto position = Dicom::element(0x20, 0x32, "DS", "5\\6\\7"),
               turned = Dicom::element(0x20, 0x37, "DS", "0\\1\\0\\0\\0\\1");
    auto nuclear = last_element(Dicom::sequence(0x54, 0x22, {position + turned}));
    nuclear.spacing_between_slices = -4;
    volume = read(folder.write("nuclear.dcm", nuclear.bytes()));
    EXPECT_EQ(first_pixels(volume), (std::vector{24, 12, 0}));  // along the normal, +x
    expect_near(volume.geometry.origin_mm, {-3, 6, 7});
    expect_near(volume.geometry.spacing_mm, {0.5, 2, 4});
    expect_near(volume.geometry.direction[2], {1, 0, 0});
    volume = read(folder.write("cine.dcm", Dicom{.pixels = ramp<std::uint16_t>(36), .frames = 3}.bytes()));
    EXPECT_TRUE(has_note(volume, "state no position"));
    EXPECT_EQ(first_pixels(volume), (std::vector{0, 12, 24}));
}

TEST(Dicom, FramesOfTwoStacksAreTwoSeries) {
    const Folder folder;
    std::vector<std::string> frames;
    for (int i = 0; i < 5; ++i) {
        const bool sagittal = i >= 3;
        frames.push_back(
            Dicom::sequence(0x20, 0x9113,
                            {Dicom::element(0x20, 0x32, "DS",
                                            sagittal ? std::to_string(i) + "\\0\\0" : "0\\0\\" + std::to_string(i))}) +
            Dicom::sequence(0x20, 0x9116,
                            {Dicom::element(0x20, 0x37, "DS", sagittal ? "0\\1\\0\\0\\0\\1" : "1\\0\\0\\0\\1\\0")}));
    }
    Dicom image{.pixels = ramp<std::uint16_t>(60), .frames = 5};
    image.functional_groups = Dicom::sequence(0x5200, 0x9230, frames);
    const auto name = folder.write("enhanced.dcm", image.bytes());
    EXPECT_EQ(first_pixels(read(name)), (std::vector{0, 12, 24}));
    EXPECT_EQ(first_pixels(read(name, {.raw = {}, .series = "2", .rescale = {}})), (std::vector{36, 48}));
}

// NRRD, MetaImage, NIfTI and raw: exact voxels and geometry, in and out.
#include "io/wire.h"
#include "volume_files.h"

#include <chiaro/error.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

using namespace chiaro;
using namespace volume_files;

namespace {

const auto shorts = ramp<std::int16_t>(24, -7);

std::string nrrd(const std::string& fields, const std::string& data) {
    return "NRRD0004\n# a comment\n" + fields + "\n" + data;
}
const std::string short_fields = "type: short\ndimension: 3\nsizes: 4 3 2\n";

// Whatever a helper says: numbers that are none of int's have no answer of their own.
TEST(Wire, HeadersHoldWholeNumbers) {
    const nlohmann::json good = wire::header_to_json(Volume());
    EXPECT_EQ(wire::header_from_json(good).components, Volume().components);
    for (const double wrong : {2.6e27, -1e300}) {
        nlohmann::json dimensions = good, components = good;
        dimensions["dimensions"][2] = wrong, components["components"] = wrong;
        EXPECT_THROW(wire::header_from_json(dimensions), std::exception);
        EXPECT_THROW(wire::header_from_json(components), std::exception);
    }
}

}  // namespace

TEST(Nrrd, RawLittleEndianWithSpacings) {
    const Folder folder;
    const auto volume = read(
        folder.write("a.nrrd", nrrd(short_fields + "spacings: 0.5 2 3\nendian: little\nencoding: raw\nkey one:=a\\nb\n",
                                    bytes_of_all(shorts))));
    EXPECT_EQ(volume.dimensions, (std::array{4, 3, 2}));
    EXPECT_EQ(voxels_of<std::int16_t>(volume), shorts);
    EXPECT_EQ(volume.geometry, (Geometry{.spacing_mm = {0.5, 2, 3}}));
    EXPECT_EQ(volume.key_values.at("key one"), "a\nb");
    EXPECT_EQ(volume.format, "NRRD");
}

TEST(Nrrd, BigEndianGzipWithRasDirections) {
    const Folder folder;
    const auto volume = read(folder.write(
        "a.nrrd", nrrd(short_fields + "space: right-anterior-superior\nspace directions: (0,2,0) (-0.5,0,0) (0,0.3,3)\n"
                                      "space origin: (1,-2,3.5)\nendian: big\nencoding: gzip\n",
                       deflated(bytes_of_all(shorts, true)))));
    EXPECT_EQ(voxels_of<std::int16_t>(volume), shorts);
    EXPECT_EQ(volume.geometry.world, World::ras);
    expect_near(volume.geometry.origin_mm, {1, -2, 3.5});
    expect_near(volume.geometry.world_from_voxel_vector({1, 0, 0}), {0, 2, 0});
    expect_near(volume.geometry.world_from_voxel_vector({0, 1, 0}), {-0.5, 0, 0});
    expect_near(volume.geometry.world_from_voxel_vector({0, 0, 1}), {0, 0.3, 3});
}

TEST(Nrrd, LasIsGivenAsLpsWithANote) {
    const Folder folder;
    const auto volume =
        read(folder.write("a.nrrd", nrrd(short_fields + "space: LAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
                                                        "space origin: (1,2,3)\nendian: little\nencoding: raw\n",
                                         bytes_of_all(shorts))));
    EXPECT_EQ(volume.geometry.world, World::lps);
    expect_near(volume.geometry.origin_mm, {1, -2, 3});
    expect_near(volume.geometry.direction[1], {0, -1, 0});
    EXPECT_TRUE(has_note(volume, "left-anterior-superior"));
}

TEST(Nrrd, DetachedInOneFileAListAndAPattern) {
    const Folder folder;
    const std::string all = bytes_of_all(shorts);
    folder.write("all.raw", "xy" + all);
    folder.write("s1.raw", all.substr(0, 24));
    folder.write("s2.raw", all.substr(24));
    const std::string fields = short_fields + "endian: little\nencoding: raw\n";
    for (const std::string data : {"byte skip: 2\ndata file: ./all.raw\n", "byteskip: -1\ndatafile: all.raw\n",
                                   "data file: s%d.raw 1 2 1\n", "data file: LIST\ns1.raw\ns2.raw\n"})
        EXPECT_EQ(voxels_of<std::int16_t>(read(folder.write("a.nhdr", "NRRD0004\n" + fields + data))), shorts) << data;
}

TEST(Nrrd, AsciiListsAndFourDimensions) {
    const Folder folder;
    const auto text = read(
        folder.write("a.nrrd", nrrd("type: float\ndimension: 3\nsizes: 2 1 2\nencoding: ascii\n", "1.5 -2\n3e2, 4\n")));
    EXPECT_EQ(voxels_of<float>(text), (std::vector<float>{1.5, -2, 300, 4}));
    const auto colours = read(
        folder.write("b.nrrd", nrrd("type: uchar\ndimension: 4\nsizes: 3 2 2 2\nkinds: RGB-color domain domain domain\n"
                                    "encoding: raw\n",
                                    bytes_of_all(ramp<std::uint8_t>(24)))));
    EXPECT_EQ(colours.components, 3);
    EXPECT_EQ(colours.dimensions, (std::array{2, 2, 2}));
    const auto series = read(folder.write("c.nrrd", nrrd("type: uchar\ndimension: 4\nsizes: 2 2 2 3\nencoding: raw\n",
                                                         bytes_of_all(ramp<std::uint8_t>(24)))));
    EXPECT_EQ(voxels_of<std::uint8_t>(series), ramp<std::uint8_t>(8));
    EXPECT_TRUE(has_note(series, "3 moments"));
}

TEST(MetaImage, AttachedDetachedAndCompressed) {
    const Folder folder;
    const std::string fields =
        "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\nElementSpacing = 0.5 2 3\n"
        "Offset = 1 2 3\nBinaryData = True\n";
    const std::string turned = "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nAnatomicalOrientation = ARI\n";
    folder.write("a.raw", bytes_of_all(shorts, true));
    const auto big = read(folder.write("a.mhd", fields + "BinaryDataByteOrderMSB = True\nElementDataFile = a.raw\n"));
    EXPECT_EQ(voxels_of<std::int16_t>(big), shorts);
    EXPECT_EQ(big.geometry.world, World::unknown);
    expect_near(big.geometry.origin_mm, {1, 2, 3});
    const auto packed =
        read(folder.write("a.mha", fields + turned + "CompressedData = True\nElementDataFile = LOCAL\n" +
                                       deflated(bytes_of_all(shorts), 15)));
    EXPECT_EQ(voxels_of<std::int16_t>(packed), shorts);
    EXPECT_EQ(packed.geometry.world, World::lps);
    expect_near(packed.geometry.spacing_mm, {0.5, 2, 3});
    expect_near(packed.geometry.direction[0], {0, 1, 0});
    expect_near(packed.geometry.direction[1], {-1, 0, 0});
}

TEST(Nifti, SformComesBeforeQform) {
    const Folder folder;
    auto header = Nifti(4, 16).qform(0, 0, 1, {10, 20, 30}).sform({0, -2, 0, 5, 0.5, 0, 0, 6, 0, 0, 3, 7});
    const auto both = read(folder.write("a.nii", header.bytes() + bytes_of_all(shorts)));
    EXPECT_EQ(voxels_of<std::int16_t>(both), shorts);
    EXPECT_EQ(both.geometry.world, World::ras);
    expect_near(both.geometry.origin_mm, {5, 6, 7});
    expect_near(both.geometry.direction[0], {0, 1, 0});
    expect_near(both.geometry.direction[1], {-1, 0, 0});
    header.set<std::int16_t>(254, 0);
    const auto quaternion = read(folder.write("b.nii", header.bytes() + bytes_of_all(shorts)));
    expect_near(quaternion.geometry.origin_mm, {10, 20, 30});
    expect_near(quaternion.geometry.direction[0], {-1, 0, 0});  // half a turn about z
    expect_near(quaternion.geometry.spacing_mm, {0.5, 2, 3});
    header.set<std::int16_t>(252, 0);
    EXPECT_EQ(read(folder.write("c.nii", header.bytes() + bytes_of_all(shorts))).geometry.world, World::unknown);
}

TEST(Nifti, ScaleIsKeptBesideTheStoredIntegers) {
    const Folder folder;
    const auto header = Nifti(4, 16, true).set<float>(112, 0.25F).set<float>(116, -3.0F);
    const auto volume = read(folder.write("a.nii.gz", deflated(header.bytes() + bytes_of_all(shorts, true))));
    EXPECT_EQ(voxels_of<std::int16_t>(volume), shorts);
    EXPECT_EQ(volume.slope, 0.25);
    EXPECT_EQ(volume.intercept, -3);
    const auto statistics = measure(volume);
    EXPECT_EQ(statistics.min, 0.25 * -7 - 3);
    EXPECT_EQ(statistics.max, 0.25 * 16 - 3);
}

TEST(Nifti, PairsAndVersionTwo) {
    const Folder folder;
    auto pair = Nifti(2, 8);
    pair.set<float>(108, 0).set<char>(345, 'i');
    folder.write("p.img", bytes_of_all(ramp<std::uint8_t>(24)));
    EXPECT_EQ(voxels_of<std::uint8_t>(read(folder.write("p.hdr", pair.bytes().substr(0, 348)))),
              ramp<std::uint8_t>(24));
    std::string two(544, '\0');
    const auto put = [&](std::size_t at, const std::string& bytes) { two.replace(at, bytes.size(), bytes); };
    put(0, bytes_of<std::int32_t>(540) + std::string("n+2\0\r\n\032\n", 8) + bytes_of<std::int16_t>(2) +
               bytes_of<std::int16_t>(8));
    put(16, bytes_of_all(std::vector<std::int64_t>{3, 4, 3, 2, 1, 1, 1, 1}));
    put(104, bytes_of_all(std::vector<double>{1, 0.5, 2, 3}));
    put(168, bytes_of<std::int64_t>(544));
    put(348, bytes_of<std::int32_t>(1));
    put(400, bytes_of_all(std::vector<double>{0.5, 0, 0, 9, 0, 2, 0, 8, 0, 0, 3, 7}));
    const auto volume = read(folder.write("two.nii", two + bytes_of_all(ramp<std::uint8_t>(24))));
    EXPECT_EQ(voxels_of<std::uint8_t>(volume), ramp<std::uint8_t>(24));
    expect_near(volume.geometry.origin_mm, {9, 8, 7});
}

TEST(Raw, LayoutFromNameAndOptions) {
    const Folder folder;
    const std::string bytes = bytes_of_all(shorts);
    EXPECT_EQ(voxels_of<std::int16_t>(read(folder.write("a_4x3x2_int16.raw", bytes))), shorts);
    EXPECT_EQ(voxels_of<std::int16_t>(read(folder.write("a-4x3x2-int16", bytes))), shorts);
    ReadOptions options;
    options.raw = {.dimensions = std::array{4, 3, 2},
                   .type = VoxelType::i16,
                   .spacing_mm = Vec3{1, 2, 3},
                   .big_endian = true,
                   .offset = 5};
    const auto volume = read(folder.write("b.bin", "hello" + bytes_of_all(shorts, true)), options);
    EXPECT_EQ(voxels_of<std::int16_t>(volume), shorts);
    expect_near(volume.geometry.spacing_mm, {1, 2, 3});
    EXPECT_THROW(read(folder.write("c_4x3x3_int16.raw", bytes)), Error);
    EXPECT_THROW(read(folder.write("d_4x3x1_int16.raw", bytes)), Error);
    EXPECT_THROW(read(folder.write("h_-4x3x2_int16.raw", bytes)), Error);
    for (const Vec3& spacing : {Vec3{1e-13, 1e-13, 1e-13}, Vec3{1e13, 1e13, 1e13}, Vec3{1, 1, 2e6}}) {
        options.raw.spacing_mm = spacing;
        EXPECT_THROW(read((folder / "b.bin").string(), options), Error) << spacing.z;
    }
}

TEST(WriteNrrd, RoundTripKeepsVoxelsGeometryAndKeys) {
    const Folder folder;
    Volume volume = make_volume({4, 3, 2}, VoxelType::i16);
    std::copy(shorts.begin(), shorts.end(), volume.as<std::int16_t>().begin());
    volume.key_values = {{"a key", "two\nlines \\ and := more"}};
    for (const World world : {World::unknown, World::lps, World::ras})
        for (const auto encoding : {NrrdEncoding::raw, NrrdEncoding::gzip}) {
            volume.geometry = {.spacing_mm = {0.1, 2, 3}, .world = world};
            if (world != World::unknown)
                volume.geometry.direction = {normalized({1, 2, 0}), normalized({-2, 1, 0.5}), {0, 0, -1}};
            if (world == World::ras) volume.geometry.origin_mm = {1. / 3, -2, 1e-7};
            write_nrrd(volume, folder / "out.nrrd", encoding);
            const auto again = read((folder / "out.nrrd").string());
            EXPECT_EQ(voxels_of<std::int16_t>(again), shorts);
            EXPECT_EQ(again.key_values, volume.key_values);
            EXPECT_EQ(again.geometry.world, world);
            expect_near(again.geometry.origin_mm, volume.geometry.origin_mm, 1e-15);
            expect_near(again.geometry.spacing_mm, volume.geometry.spacing_mm, 1e-15);
            for (std::size_t axis = 0; axis < 3; ++axis)
                expect_near(again.geometry.direction[axis], volume.geometry.direction[axis], 1e-15);
        }
}

TEST(WriteNrrd, AppliesSlopeInTheSmallestTypeThatHoldsIt) {
    const Folder folder;
    Volume volume = make_volume({2, 1, 1}, VoxelType::u16);
    volume.as<std::uint16_t>()[1] = 3000;
    volume.intercept = -1024;
    write_nrrd(volume, folder / "hu.nrrd", NrrdEncoding::raw);
    EXPECT_EQ(voxels_of<std::int16_t>(read((folder / "hu.nrrd").string())), (std::vector<std::int16_t>{-1024, 1976}));
    volume.slope = 0.5;
    write_nrrd(volume, folder / "half.nrrd", NrrdEncoding::gzip);
    EXPECT_EQ(voxels_of<float>(read((folder / "half.nrrd").string())), (std::vector<float>{-1024, 476}));
}

TEST(WriteNrrd, LeavesNothingBehindWhenItFails) {
    const Folder folder;
    const Volume volume = make_volume({64, 64, 64}, VoxelType::f32);
    for (const std::string& name :
         {std::string("/dev/full"), (folder / "no/such/folder.nrrd").string(), folder.name()}) {
        try {
            write_nrrd(volume, name, NrrdEncoding::raw);
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::output) << error.what();
        }
    }
    EXPECT_TRUE(fs::is_empty(folder.name()));
}

TEST(ReadVolume, CountsVoxelsThatAreNotFinite) {
    const Folder folder;
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const auto volume =
        read(folder.write("a.nrrd", nrrd("type: float\ndimension: 3\nsizes: 2 2 1\nendian: little\nencoding: raw\n",
                                         bytes_of_all(std::vector<float>{nan, 1, -infinity, 5}))));
    EXPECT_TRUE(has_note(volume, "2 voxels are not finite"));
    const auto statistics = measure(volume);
    EXPECT_EQ(statistics.nonfinite, 2U);
    EXPECT_EQ(statistics.min, 1);
    EXPECT_EQ(statistics.max, 5);
}

TEST(ReadVolume, ReportsProgressAndCanBeCancelled) {
    const Folder folder;
    const auto name = folder.write("a_64x64x64_uint8.raw", std::string(64 * 64 * 64, 'x'));
    std::vector<double> seen;
    Progress progress([&](std::string_view, double fraction) { seen.push_back(fraction); });
    read_volume(name, {}, progress);
    EXPECT_EQ(seen.front(), 0);
    EXPECT_EQ(seen.back(), 1);
    progress.cancel();
    EXPECT_THROW(read_volume(name, {}, progress), Error);
}

TEST(Measure, CountsExactlyAndTurnsAroundWithANegativeSlope) {
    Volume volume = make_volume({100, 1, 1}, VoxelType::u8);
    for (std::size_t i = 0; i < 100; ++i) volume.as<std::uint8_t>()[i] = std::uint8_t(i);
    auto statistics = measure(volume);
    EXPECT_EQ(statistics.p1, 0);
    EXPECT_EQ(statistics.p50, 49);
    EXPECT_EQ(statistics.p99, 98);
    EXPECT_EQ(statistics.p999, 99);
    volume.slope = -2;
    volume.intercept = 1;
    statistics = measure(volume);
    EXPECT_EQ(statistics.min, 1 - 2 * 99);
    EXPECT_EQ(statistics.max, 1);
    EXPECT_EQ(statistics.p50, 1 - 2 * 50);
    std::uint64_t sum = 0;
    for (const auto count : statistics.histogram) sum += count;
    EXPECT_EQ(sum, 100U);
}

/// Voxels beyond what memory may take are read through a file on disk, which leaves nothing behind.
TEST(Io, VoxelsThatExceedTheMemoryAreReadThroughAFile) {
    const Folder folder;
    const fs::path spill = fs::path(folder.name()) / "spill" / "deep";
    Progress progress;
    const Volume made = make_sample("shells", 40);
    const std::string packed = folder.name() + "/packed.nrrd", raw = folder.name() + "/shells_40x40x40_uint8.raw";
    write_nrrd(made, packed, NrrdEncoding::gzip);
    std::ofstream(raw, std::ios::binary)
        .write(reinterpret_cast<const char*>(made.voxels.data()), std::streamsize(made.voxels.size()));
    for (const std::string& name : {packed, raw}) {
        ReadOptions options;
        options.max_bytes = 40 * 40 * 40 - 1;
        try {
            read_volume(name, options, progress);
            ADD_FAILURE() << "not refused";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("MiB may be used"), std::string::npos) << error.what();
        }
        options.spill = spill;
        const Volume read = read_volume(name, options, progress);
        ASSERT_EQ(read.voxels.size(), made.voxels.size());
        EXPECT_TRUE(std::equal(read.voxels.data(), read.voxels.data() + read.voxels.size(), made.voxels.data()));
        EXPECT_TRUE(fs::is_empty(spill));
        options.spill = name;  // no folder
        EXPECT_THROW(read_volume(name, options, progress), Error);
    }
}

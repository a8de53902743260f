// OpenVDB's grids: every voxel and its place as the library that wrote them has it; what is not read is named.
#include "vdb_files.h"

#include <chiaro/brick_source.h>
#include <chiaro/error.h>
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "refusal.h"
#include "tool_case.h"
#include "vdb_bytes.h"

using namespace chiaro;
using namespace volume_files;
using openvdb::DoubleGrid, openvdb::FloatGrid, openvdb::math::Transform;

namespace {

std::string vdb_notes(const Volume& volume) { return fmt::format("{}", fmt::join(volume.notes, "; ")); }

template <class GridT>
void expect_same_voxels(const Volume& volume, const GridT& grid) {
    using T = typename GridT::ValueType;
    const auto expected = voxels_of(grid);
    const Coord size = grid.evalActiveVoxelBoundingBox().dim();
    ASSERT_EQ(volume.dimensions, (std::array{size[0], size[1], size[2]}));
    ASSERT_EQ(volume.type, (std::is_same_v<T, double> ? VoxelType::f64 : VoxelType::f32));
    ASSERT_EQ(volume.voxels.size(), expected.size() * sizeof(T));
    EXPECT_EQ(std::memcmp(volume.voxels.data(), expected.data(), volume.voxels.size()), 0);
}

/// The transform is the grid's own, of the centres of its voxels.
void expect_same_place(const Volume& volume, const FloatGrid& grid, double tolerance) {
    const Coord first = grid.evalActiveVoxelBoundingBox().min();
    for (const auto& at :
         {std::array{0, 0, 0}, std::array{1, 0, 0}, std::array{0, 1, 0}, std::array{0, 0, 1}, std::array{17, 5, 9}}) {
        const Vec3 found = volume.geometry.world_from_voxel({double(at[0]), double(at[1]), double(at[2])});
        const auto expected = grid.transform().indexToWorld(first + Coord(at[0], at[1], at[2]));
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], expected[axis], tolerance);
    }
    EXPECT_EQ(volume.geometry.world, World::unknown);
}

struct Vdb : testing::Test {
    const Folder folder;
    const std::string path = (folder / "a.vdb").string();
};

constexpr std::uint32_t packed_by[] = {
    openvdb::io::COMPRESS_NONE,  openvdb::io::COMPRESS_ACTIVE_MASK,
    openvdb::io::COMPRESS_ZIP,   openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK,
    openvdb::io::COMPRESS_BLOSC, openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK};

}  // namespace

TEST_F(Vdb, EveryVoxelIsTheLibrarysHoweverItIsPacked) {
    for (const std::uint32_t packed : packed_by)
        for (const double background : {0.0, -3.25, 0.1}) {
            SCOPED_TRACE(fmt::format("{}, background {}", openvdb::io::compressionToString(packed), background));
            const auto floats = some_grid<FloatGrid>("density", background);
            const auto doubles = some_grid<DoubleGrid>("fine", background);
            write_vdb(path, {floats, doubles}, packed);
            expect_same_voxels(read(path), *floats);
            expect_same_voxels(read(path + "#fine"), *doubles);
        }
}

TEST_F(Vdb, HalfFloatsAreWhatTheLibraryMakesOfThem) {
    for (const std::uint32_t packed : packed_by) {
        SCOPED_TRACE(openvdb::io::compressionToString(packed));
        const auto grid = some_grid<FloatGrid>("density", 0.1);
        const auto doubles = some_grid<DoubleGrid>("fine", 0.1);
        grid->setSaveFloatAsHalf(true), doubles->setSaveFloatAsHalf(true);
        write_vdb(path, {grid, doubles}, packed);
        const auto stored = volume_files::read_vdb<FloatGrid>(path, "density");
        EXPECT_NE(voxels_of(*stored), voxels_of(*grid)) << "of 16 bits";
        expect_same_voxels(read(path), *stored);
        expect_same_voxels(read(path + "#fine"), *volume_files::read_vdb<DoubleGrid>(path, "fine"));
    }
}

TEST_F(Vdb, LargeCubesOfOneValueAndTheRootsOwn) {
    const auto grid = some_grid<FloatGrid>("density", 0.5, 128);
    write_vdb(path, {grid});
    expect_same_voxels(read(path), *grid);
    const auto far = FloatGrid::create(-2);
    far->tree().addTile(3, Coord(-4096, 0, 0), 7, false);  // inactive: it takes no part in the box, but has its value
    far->tree().addTile(1, Coord(-8, 0, 0), 1, true);
    far->tree().setValue(Coord(5, 1, -4), 3);
    write_vdb(path, {far});
    expect_same_voxels(read(path), *far);
    const auto at_the_end = FloatGrid::create(0);
    at_the_end->tree().setValue(Coord(INT32_MAX, INT32_MIN, 5), 3);
    at_the_end->tree().setValue(Coord(INT32_MAX - 9, INT32_MIN + 3, -4), 4);
    write_vdb(path, {at_the_end});
    expect_same_voxels(read(path), *at_the_end);
}

TEST_F(Vdb, TheTransformPlacesVoxels) {
    const auto grid = some_grid<FloatGrid>("density", 0);
    const auto check = [&](const Transform::Ptr& transform, double tolerance) {
        grid->setTransform(transform);
        write_vdb(path, {grid});
        expect_same_place(read(path), *grid, tolerance);
    };
    check(Transform::createLinearTransform(1), 0);
    check(Transform::createLinearTransform(0.25), 0);
    auto scaled = Transform::createLinearTransform(1);
    scaled->preScale(openvdb::Vec3d(0.5, 2, 3));
    check(scaled, 0);
    scaled->postTranslate(openvdb::Vec3d(-7, 1.5, 1024));
    check(scaled, 0);
    auto moved = Transform::createLinearTransform(1);
    moved->postTranslate(openvdb::Vec3d(0.5, 0.5, 0.5));
    check(moved, 0);
    auto turned = Transform::createLinearTransform(0.3);
    turned->preScale(openvdb::Vec3d(1, -2, 3));
    turned->postRotate(0.7, openvdb::math::X_AXIS), turned->postRotate(-1.9, openvdb::math::Z_AXIS);
    turned->postTranslate(openvdb::Vec3d(10, 20, -30));
    check(turned, 1e-13);
    turned->preShear(0.4, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
    check(turned, 1e-13);
    EXPECT_NE(vdb_notes(read(path)).find("states no unit; mm are taken"), std::string::npos);
}

TEST_F(Vdb, OneOfSeveralGridsIsChosenByName) {
    const auto velocity = openvdb::Vec3SGrid::create();
    velocity->setName("v"), velocity->tree().setValue(Coord(0), openvdb::Vec3s(1, 2, 3));
    const auto first = some_grid<FloatGrid>("density", 0), same = some_grid<FloatGrid>("density", 4),
               third = some_grid<FloatGrid>("/obj/heat", 1);
    const openvdb::GridBase::Ptr shared = first->copyGrid();  // of the same tree
    shared->setName("shared");
    shared->setTransform(Transform::createLinearTransform(2));
    write_vdb(path, {velocity, first, same, third, shared});
    const Volume shown = read(path);
    expect_same_voxels(shown, *first);
    EXPECT_NE(vdb_notes(shown).find("holds 5 grids; 'density[0]' is shown (FILE#NAME is another): v (vectors), "
                                    "density[0], density[1], /obj/heat, shared"),
              std::string::npos)
        << vdb_notes(shown);
    expect_same_voxels(read(path + "#density[1]"), *same);
    expect_same_voxels(read(path + ":/density[1]"), *same);
    for (const char* name : {"#/obj/heat", "#obj/heat", ":/obj/heat"}) expect_same_voxels(read(path + name), *third);
    const Volume of_shared = read(path + "#shared");
    expect_same_voxels(of_shared, *first);
    EXPECT_EQ(of_shared.geometry.spacing_mm, (Vec3{2, 2, 2}));
    expect_refused(path + "#v", "holds in its grid 'v' vectors");
    expect_refused(path + "#heat", "holds no grid 'heat', but v (vectors), density[0]");
}

TEST_F(Vdb, WhatIsNotReadIsNamed) {
    write_vdb(path, {openvdb::tools::createLevelSetSphere<FloatGrid>(3, openvdb::Vec3f(0), 0.5F)});
    expect_refused(path, "a level set");
    const auto grid = some_grid<FloatGrid>("density", 0);
    grid->setTransform(Transform::createFrustumTransform(openvdb::BBoxd({0, 0, 0}, {9, 9, 9}), 0.5, 10));
    write_vdb(path, {grid});
    expect_refused(path, "whose transform is a frustum");
    write_vdb(path, {FloatGrid::create(1)});
    expect_refused(path, "in which no voxel is active");
    const auto wide = FloatGrid::create(0);
    wide->tree().setValue(Coord(0), 1), wide->tree().setValue(Coord(100000, 0, 0), 1);
    write_vdb(path, {wide});
    expect_refused(path, "states 100001 x 1 x 1 voxels");
    const auto large = FloatGrid::create(0);
    large->tree().setValue(Coord(0), 1), large->tree().setValue(Coord(60000, 60000, 60000), 1);
    write_vdb(path, {large});
    expect_refused(path, "MiB");
    const auto integers = openvdb::Int32Grid::create();
    integers->setName("labels"), integers->tree().setValue(Coord(1), 3);
    write_vdb(path, {integers});
    expect_refused(path, "holds no grid of floats, but labels (integers)");
    write_vdb(path, {});
    expect_refused(path, "states 0 grids");
    const auto small = Transform::createLinearTransform(1);
    small->preScale(openvdb::Vec3d(1, 1e-8, 1));
    const auto flat = some_grid<FloatGrid>("density", 0);
    flat->setTransform(small);
    write_vdb(path, {flat});
    expect_refused(path, "spacing");
}

TEST_F(Vdb, FilesOfEveryVersionAreReadAsTheLibraryReadsThem) {
    openvdb::initialize();
    for (const std::uint32_t version : {220, 221, 222, 223, 224})
        for (const bool is_packed : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {}", version, is_packed));
            folder.write("a.vdb", VdbBytes{.version = version, .is_packed = is_packed}.bytes());
            const Volume volume = read(path);
            const auto stored = volume_files::read_vdb<FloatGrid>(path, "density");
            expect_same_voxels(volume, *stored);
            expect_same_place(volume, *stored, 0);
            const auto values = volume.as<float>();
            ASSERT_EQ(volume.dimensions, (std::array{8, 8, 16}));
            EXPECT_EQ(values[0], 512);
            EXPECT_EQ(values[7 + 8 * (6 + 8 * 5)], 512 + 7 * 64 + 6 * 8 + 5);
            EXPECT_EQ(values[8 * 8 * 8], 3.5F);
            EXPECT_EQ(volume.geometry.origin_mm, (Vec3{1 + 0.5 * 128, -2 + 2 * 8, 3.5}));
            const auto bricks = open_brick_source(path, {});
            ASSERT_TRUE(bricks);
            Progress progress;
            const Volume by_bricks = read_level(*bricks, 0, progress);
            EXPECT_EQ(std::memcmp(by_bricks.voxels.data(), volume.voxels.data(), volume.voxels.size()), 0);
        }
    for (const std::uint32_t version : {219, 225}) {
        folder.write("a.vdb", VdbBytes{.version = version}.bytes());
        expect_refused(path, "220 to 224 are read");
    }
}

TEST_F(Vdb, DamagedFilesAreOneSentence) {
    const auto grid = some_grid<FloatGrid>("density", 0.5);
    std::mt19937 random(5);
    for (const bool is_half : {false, true})
        for (const std::uint32_t packed : packed_by) {
            grid->setSaveFloatAsHalf(is_half);
            write_vdb(path, {grid, some_grid<DoubleGrid>("other", 0)}, packed);
            const std::string whole = content_of(path);
            for (int i = 0; i < 6; ++i)
                expect_refused(folder.write("cut.vdb", whole.substr(0, random() % whole.size())), "cut.vdb");
            for (int i = 0; i < 12; ++i) {
                std::string changed = whole;
                // Half of the time where values are, which is most of the file only where nothing packs them.
                for (int k = 0; k < 2; ++k) {
                    const std::size_t at =
                        i % 2 ? whole.size() / 4 + random() % (whole.size() / 2) : random() % whole.size();
                    changed[at] = char(random());
                }
                try {
                    read(folder.write("changed.vdb", changed), {.max_bytes = 16 << 20});  // a bit makes a box large
                } catch (const Error& error) {
                    EXPECT_EQ(error.code(), ErrorCode::input);
                    EXPECT_EQ(std::string(error.what()).find("crashed"), std::string::npos) << error.what();
                }
            }
        }
}

TEST_F(Vdb, HugeClaimsAreOneSentence) {
    const VdbBytes good;
    const std::string whole = good.bytes();
    for (const auto& [part, at] : good.places())
        for (const std::uint32_t claim : {0x7fffffffU, 0x80000000U, 0xffffffffU}) {
            if (part == "background") continue;
            std::string bytes = whole;
            bytes.replace(at, 4, bytes_of(claim));
            folder.write("a.vdb", bytes);
            try {
                const Volume volume = read(path, {.max_bytes = 16 << 20});
                EXPECT_TRUE(part == "origin" || part == "node" || part == "low node" || part == "leaf mask" ||
                            part == "leaf" || part == "map")
                    << part;
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::input) << part;
                EXPECT_EQ(std::string(error.what()).find("crashed"), std::string::npos) << part << error.what();
            }
        }
    VdbBytes far;
    far.node = {2147479552, -2147483648, 4096};
    folder.write("a.vdb", far.bytes());
    EXPECT_EQ(read(path).dimensions, (std::array{8, 8, 16}));
    far.node = {4, 0, 0};
    folder.write("a.vdb", far.bytes());
    expect_refused(path, "has a node at 4, 0, 0 where none can be");
    for (const double length : {0.0, 1e300, std::nan("")}) {
        folder.write("a.vdb", VdbBytes{.voxel_size = {1, length, 1}}.bytes());
        expect_refused(path, "a.vdb");
    }
    folder.write("a.vdb", VdbBytes{.map = "HomeMadeMap"}.bytes());
    expect_refused(path, "whose transform is a 'HomeMadeMap'");
}

TEST_F(Vdb, BricksAreThoseOfTheWholeVolume) {
    for (const bool is_half : {false, true}) {
        const auto grid = some_grid<FloatGrid>("density", 0.5, 128);
        grid->tree().setValue(Coord(-101, 77, 130), 9);
        grid->setSaveFloatAsHalf(is_half);
        write_vdb(path, {some_grid<DoubleGrid>("other", 0), grid});
        Progress progress;
        const Volume whole = read(path + "#density");
        const auto source = open_brick_source(path + "#density", {});
        ASSERT_TRUE(source);
        const Volume level = read_level(*source, 0, progress);
        ASSERT_EQ(level.dimensions, whole.dimensions);
        EXPECT_EQ(level.geometry, whole.geometry);
        EXPECT_EQ(std::memcmp(level.voxels.data(), whole.voxels.data(), whole.voxels.size()), 0);
        ASSERT_TRUE(open_brick_source(path + "#other", {}));
    }
}

TEST_F(Vdb, AFileOfKilobytesMayHoldWhatFitsNowhere) {
    const auto grid = some_grid<FloatGrid>("density", -1);
    for (int i = 0; i < 40; ++i) grid->tree().setValue(Coord(5000 + i % 3, 3000 + i % 5, 9000 - i), float(i));
    write_vdb(path, {grid});
    const auto source = open_brick_source(path, {});
    ASSERT_TRUE(source);
    const CoordBBox box = grid->evalActiveVoxelBoundingBox();
    ASSERT_EQ(source->header().dimensions, (std::array{box.dim()[0], box.dim()[1], box.dim()[2]}));
    const auto expect_same_around = [&](const Coord& centre) {
        const VoxelBox part{
            {centre[0] - box.min()[0] - 30, centre[1] - box.min()[1] - 20, centre[2] - box.min()[2] - 50},
            {31, 24, 51}};
        std::vector<float> voxels(31 * 24 * 51);
        source->read(0, part, reinterpret_cast<std::byte*>(voxels.data()));
        std::size_t i = 0;
        for (int z = 0; z < part.size[2]; ++z)
            for (int y = 0; y < part.size[1]; ++y)
                for (int x = 0; x < part.size[0]; ++x, ++i)
                    ASSERT_EQ(voxels[i], grid->tree().getValue(box.min() + Coord(part.first[0] + x, part.first[1] + y,
                                                                                 part.first[2] + z)));
    };
    expect_same_around(Coord(5002, 3001, 9000)), expect_same_around(Coord(2000, 2000, 2000));
    expect_same_around(Coord(22, 20, 60)), expect_same_around(Coord(5002, 3001, 9000));
}

TEST_F(Vdb, TheDecoderHasOneThreadUnderItsFilter) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "skipped: the sanitized decoder has no filter";
#endif
    write_vdb(path, {some_grid<FloatGrid>("density", 0)});
    const auto source = open_brick_source(path, {});
    ASSERT_TRUE(source);
    int decoders = 0;
    for (const auto& process : fs::directory_iterator("/proc")) {
        if (content_of(process.path() / "cmdline").find(path) == std::string::npos ||
            content_of(process.path() / "comm").find("chiaro-decode") != 0)
            continue;
        ++decoders;
        int threads = 0;
        for (const auto& thread : fs::directory_iterator(process.path() / "task")) {
            ++threads;
            EXPECT_NE(content_of(thread.path() / "status").find("Seccomp:\t2"), std::string::npos);
        }
        EXPECT_EQ(threads, 1);
    }
    EXPECT_EQ(decoders, 1);
}

class VdbTool : public ToolTest {};

TEST_F(VdbTool, APictureIsThatOfTheSameVoxelsBitForBit) {
    const auto grid = some_grid<FloatGrid>("density", -1);
    auto transform = Transform::createLinearTransform(1);
    transform->preScale(openvdb::Vec3d(1, 2, 0.5));
    grid->setTransform(transform);
    write_vdb(folder / "a.vdb", {grid});
    const auto voxels = voxels_of(*grid);
    const CoordBBox box = grid->evalActiveVoxelBoundingBox();
    const auto origin = transform->indexToWorld(box.min());
    write("a.nrrd", fmt::format("NRRD0005\ntype: float\ndimension: 3\nsizes: {} {} {}\nspace dimension: 3\n"
                                "space directions: (1,0,0) (0,2,0) (0,0,0.5)\nspace origin: ({},{},{})\n"
                                "endian: little\nencoding: raw\n\n",
                                box.dim()[0], box.dim()[1], box.dim()[2], origin[0], origin[1], origin[2]) +
                        bytes_of_all(voxels));
    for (const std::string name : {"vdb", "nrrd"}) {
        const Said said = tool("render a." + name + " -o " + name + ".png --size 160x120 --lighting visibility");
        ASSERT_EQ(said.code, 0) << said.err;
    }
    const Said same = tool("compare vdb.png nrrd.png --fail-above max=0");
    EXPECT_EQ(same.code, 0) << same.out << same.err;
    const Said info = tool("info a.vdb --json");
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_EQ(nlohmann::json::parse(info.out).at("format"), "OpenVDB");
    auto voxels_far_away = volume_files::some_grid<FloatGrid>("far", 0);
    voxels_far_away->tree().setValue(Coord(500, 400, 1000), 1);
    write_vdb(folder / "far.vdb", {voxels_far_away});
    const Said paged = tool("render far.vdb -o far.png --size 80x60 --lighting none --memory 64M");
    EXPECT_EQ(paged.code, 0) << paged.err;
    EXPECT_NE(paged.err.find("is drawn"), std::string::npos) << paged.err;
    write("b.vdb", read("a.vdb").substr(0, 2000));
    EXPECT_EQ(tool("render b.vdb -o b.png").code, 3);
}

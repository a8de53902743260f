// Voxels by bricks are those of whole volumes.
#include <chiaro/error.h>
#include <chiaro/io.h>
#include <chiaro/samples.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

using namespace chiaro;

namespace {

template <class T>
std::vector<T> voxels_in(const BrickSource& source, int level, const VoxelBox& box) {
    std::vector<T> voxels(std::size_t(box.size[0]) * box.size[1] * box.size[2]);
    source.read(level, box, reinterpret_cast<std::byte*>(voxels.data()));
    return voxels;
}

/// 70 × 40 × 50 numbers in chunks of 16 × 24 × 50, of which one cannot be had.
class OwnChunks final : public ChunkReader {
public:
    static constexpr std::array<int, 3> size{70, 40, 50}, chunk{16, 24, 50}, lost{4, 1, 0};
    static std::uint16_t at(int x, int y, int z) { return std::uint16_t((z * size[1] + y) * size[0] + x); }

    explicit OwnChunks(std::atomic<int>& decoded) : decoded_(decoded) {
        header_.dimensions = size, header_.type = VoxelType::u16, header_.source = "own";
    }
    const Volume& header() const override { return header_; }
    const std::vector<ChunkedLevel>& levels() const override { return levels_; }
    void decode(int, const std::array<int, 3>& c, const Use& use) override {
        ++decoded_;
        if (c == lost) throw Error(ErrorCode::input, "own: a chunk is lost");
        std::vector<std::uint16_t> voxels(levels_[0].chunk_voxels(), 9999);
        std::size_t i = 0;
        for (int z = 0; z < chunk[2]; ++z)
            for (int y = 0; y < chunk[1]; ++y)
                for (int x = 0; x < chunk[0]; ++x, ++i)
                    if (c[0] * chunk[0] + x < size[0] && c[1] * chunk[1] + y < size[1])
                        voxels[i] = at(c[0] * chunk[0] + x, c[1] * chunk[1] + y, z);
        use(std::as_bytes(std::span(voxels)), true);
    }

private:
    Volume header_;
    std::vector<ChunkedLevel> levels_{{size, chunk, {}}};
    std::atomic<int>& decoded_;
};

}  // namespace

TEST(BrickSource, ChunksMayBeAProgramsOwn) {
    std::atomic<int> decoded = 0;
    const auto source = source_of_chunks(std::make_unique<OwnChunks>(decoded));
    ASSERT_EQ(source->levels().size(), 2u);
    EXPECT_EQ(source->levels()[1].dimensions, (std::array<int, 3>{35, 20, 25}));
    const VoxelBox box{{10, 20, 3}, {30, 18, 40}};
    std::vector<std::vector<std::uint16_t>> read(4);
    {
        std::vector<std::jthread> threads;
        for (auto& of_thread : read)
            threads.emplace_back([&] { of_thread = voxels_in<std::uint16_t>(*source, 0, box); });
    }
    EXPECT_EQ(decoded, 6) << "each chunk once, for all threads: three along x, two along y";
    for (const auto& of_thread : read) {
        std::size_t i = 0;
        for (int z = 3; z < 43; ++z)
            for (int y = 20; y < 38; ++y)
                for (int x = 10; x < 40; ++x, ++i) ASSERT_EQ(of_thread[i], OwnChunks::at(x, y, z));
    }
    const auto coarse = voxels_in<std::uint16_t>(*source, 1, {{1, 2, 3}, {5, 1, 2}});
    for (int i = 0; i < 10; ++i) EXPECT_EQ(coarse[std::size_t(i)], OwnChunks::at(3 + 2 * (i % 5), 5, 7 + 2 * (i / 5)));
    EXPECT_EQ(decoded, 6);
    for (int times = 0; times < 2; ++times)
        EXPECT_THROW(voxels_in<std::uint16_t>(*source, 0, {{66, 39, 0}, {1, 1, 1}}), Error);
    EXPECT_EQ(decoded, 7) << "what cannot be decoded is not tried again";
}

TEST(BrickSource, LevelsOfASampleAreTheSampleAtHalfTheSize) {
    const auto source = open_sample("shells", 200);
    ASSERT_EQ(source->levels().size(), 3u) << "200, 100, 50";
    Progress progress;
    for (int level = 0; level < 3; ++level) {
        const Volume whole = make_sample("shells", 200 >> level);
        const Volume read = read_level(*source, level, progress);
        EXPECT_EQ(read.dimensions, whole.dimensions);
        EXPECT_TRUE(std::ranges::equal(read.as<std::uint8_t>(), whole.as<std::uint8_t>()));
    }
    const auto box = voxels_in<std::uint8_t>(*source, 1, {{7, 8, 9}, {3, 2, 1}});
    const Volume half = make_sample("shells", 100);
    EXPECT_EQ(box[4], half.as<std::uint8_t>()[(9 * 100 + 9) * 100 + 8]);
    const Geometry& g = source->levels()[2].geometry;
    EXPECT_EQ(g.spacing_mm, (Vec3{4, 4, 4}));
    EXPECT_EQ(g.origin_mm, (Vec3{1.5, 1.5, 1.5})) << "voxels fill the same cube";
    EXPECT_EQ(open_sample("torso", 200)->header().type, VoxelType::i16);
    EXPECT_EQ(open_sample("shells", 16384)->levels()[3].dimensions[0], 2048) << "of which nothing is made";
    EXPECT_THROW(open_sample("shells", 16385), Error);
}

TEST(BrickSource, BricksOfAFileAreItsVoxels) {
    const auto path = std::filesystem::temp_directory_path() / fmt::format("chiaro-{}_70x66x9_int32.raw", getpid());
    std::vector<std::int32_t> numbers(70 * 66 * 9);
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = std::int32_t(i * 2654435761u >> 8) - (1 << 23);
    ReadOptions options;
    options.raw.spacing_mm = Vec3{1, 1, 5};
    options.raw.big_endian = true;
    {
        std::ofstream file(path, std::ios::binary);
        for (std::int32_t n : numbers) {
            auto* bytes = reinterpret_cast<char*>(&n);
            std::reverse(bytes, bytes + 4);
            file.write(bytes, 4);
        }
    }
    const auto source = open_brick_source(path, options);
    ASSERT_TRUE(source);
    EXPECT_EQ(source->header().type, VoxelType::f32) << "of whole numbers wider than 16 bits";
    const auto box = voxels_in<float>(*source, 0, {{3, 4, 5}, {2, 2, 2}});
    EXPECT_EQ(box[7], float(numbers[(6 * 66 + 5) * 70 + 4]));
    ASSERT_EQ(source->levels().size(), 2u);
    const SourceLevel& half = source->levels()[1];
    EXPECT_EQ(half.dimensions, (std::array{35, 33, 9})) << "slices are five times as thick";
    EXPECT_EQ(half.geometry.spacing_mm, (Vec3{2, 2, 5}));
    EXPECT_EQ(half.geometry.origin_mm, (Vec3{1, 1, 0}));
    const auto every_second = voxels_in<float>(*source, 1, {{2, 3, 4}, {1, 1, 1}});
    EXPECT_EQ(every_second[0], float(numbers[(4 * 66 + 7) * 70 + 5]));
    std::filesystem::resize_file(path, 1000);
    EXPECT_THROW(voxels_in<float>(*source, 0, {{0, 0, 5}, {1, 1, 1}}), Error) << "cut while it is shown";
    std::filesystem::remove(path);
}

namespace {

/// Every voxel of boxes of a raw file of these dimensions, at every level.
template <class T>
void expect_boxes(std::array<int, 3> n, const std::vector<VoxelBox>& boxes) {
    const auto path = std::filesystem::temp_directory_path() /
                      fmt::format("chiaro-{}_{}x{}x{}_{}.raw", getpid(), n[0], n[1], n[2], name_of(voxel_type_of<T>()));
    const std::size_t count = std::size_t(n[0]) * n[1] * n[2];
    std::vector<T> numbers(count);
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = T(i * 2654435761u >> 13);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(numbers.data()), std::streamsize(numbers.size() * sizeof(T)));
    const auto source = open_brick_source(path, {});
    using Kept = std::conditional_t<sizeof(T) <= 2, T, float>;
    for (int level = 0; level < 2; ++level)
        for (VoxelBox box : boxes) {
            const int stride = 1 << level, first = stride / 2;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box.first[axis] >>= level;
                box.size[axis] = std::min(box.size[axis], source->levels()[level].dimensions[axis] - box.first[axis]);
            }
            const auto read = voxels_in<Kept>(*source, level, box);
            std::size_t i = 0, wrong = 0;
            for (int z = 0; z < box.size[2]; ++z)
                for (int y = 0; y < box.size[1]; ++y)
                    for (int x = 0; x < box.size[0]; ++x) {
                        const auto at = [&](std::size_t axis, int b) {
                            return std::size_t((box.first[axis] + b) * stride + first);
                        };
                        wrong += read[i++] != Kept(numbers[(at(2, z) * n[1] + at(1, y)) * n[0] + at(0, x)]);
                    }
            EXPECT_EQ(wrong, 0u) << level << ": " << box.first[0] << ' ' << box.size[0] << ' ' << box.size[1];
        }
    std::filesystem::remove(path);
}

}  // namespace

TEST(BrickSource, AnyBoxOfAFileIsReadHoweverFarApartItsRowsLie) {
    expect_boxes<std::uint8_t>({9000, 20, 12}, {{{100, 3, 2}, {35, 9, 4}}, {{0, 1, 1}, {9000, 7, 3}}});
    expect_boxes<std::uint8_t>({700, 90, 70}, {{{31, 30, 2}, {35, 35, 35}}, {{0, 0, 0}, {700, 90, 70}}});
    expect_boxes<std::int32_t>({900, 410, 64}, {{{3, 5, 7}, {33, 35, 3}}, {{0, 0, 1}, {900, 401, 2}}});
}

TEST(BrickSource, OfAFileWithAHeaderVoxelsAreReadWhereTheyLieAsTheyAre) {
    const auto path = std::filesystem::temp_directory_path() / fmt::format("chiaro-{}.nrrd", getpid());
    write_nrrd(make_sample("ball", 8), path, NrrdEncoding::gzip);
    EXPECT_FALSE(open_brick_source(path, {}));
    Progress progress;
    const Volume torso = make_sample("torso", 64);
    write_nrrd(torso, path, NrrdEncoding::raw);
    const auto source = open_brick_source(path, {});
    ASSERT_TRUE(source);
    EXPECT_TRUE(std::ranges::equal(read_level(*source, 0, progress).as<std::int16_t>(), torso.as<std::int16_t>()));
    EXPECT_EQ(source->header().geometry, read_volume(path, {}, progress).geometry);
    std::filesystem::remove(path);
    EXPECT_THROW(open_brick_source("no such file", {}), Error);
}

// Bricks of TIFF stacks and of HDF5: those of the whole volume, of which no more is decoded than is asked for; and what
// becomes of damaged ones.
#include <chiaro/error.h>
#include <chiaro/samples.h>

#include <set>

#include "chunk_case.h"
#include "hdf5_files.h"
#include "tiff_files.h"
#include "tiff_pages.h"
#include "tool_case.h"

using namespace chiaro;
using namespace volume_files;

namespace {

/// The decoder, started by a shell that does something before.
class WrappedDecoder {
public:
    WrappedDecoder(const fs::path& script, const std::string& before) {
        std::ofstream(script) << "#!/bin/sh\n" << before << " '" << built("chiaro-decode") << "' \"$@\"\n";
        fs::permissions(script, fs::perms::owner_all);
        setenv("CHIARO_DECODE", script.c_str(), 1);
    }
    WrappedDecoder(const WrappedDecoder&) = delete;
    WrappedDecoder& operator=(const WrappedDecoder&) = delete;
    ~WrappedDecoder() { unsetenv("CHIARO_DECODE"); }
};

/// Notes which chunks are asked for.
class CountingDecoder {
public:
    explicit CountingDecoder(const Folder& folder)
        : asked_(folder / "asked"), decoder_(folder / "decode", fmt::format("tee -a '{}' |", asked_.string())) {}
    /// "LEVEL X Y Z", as often as they were asked for since the last call.
    std::multiset<std::string> asked() const {
        std::multiset<std::string> lines;
        std::ifstream file(asked_);
        for (std::string line; std::getline(file, line);) lines.insert(line);
        fs::resize_file(asked_, 0);  // which is open
        return lines;
    }

private:
    fs::path asked_;
    WrappedDecoder decoder_;
};

/// Voxels as pages; whatever a tile has beyond them repeats the last.
template <class T>
void write_stack(const std::string& name, const TiffStorage& storage, const std::vector<T>& voxels,
                 const std::array<int, 3>& n) {
    write_tiff<T>(name, storage, n, [&](int x, int y, int z, int) {
        return voxels[std::size_t((z * n[1] + std::min(y, n[1] - 1)) * n[0] + std::min(x, n[0] - 1))];
    });
}

const TiffStorage tiles{.compression = COMPRESSION_ADOBE_DEFLATE, .tiled = true, .columns = 48},
    small_tiles{.tiled = true, .columns = 16, .rows = 16},
    strips{.compression = COMPRESSION_LZW, .mode = "w8", .rows = 7},
    whole_pages{.compression = COMPRESSION_ADOBE_DEFLATE, .mode = "wb", .rows = 1000};

void write_chunked(const fs::path& path, const std::vector<float>& voxels, int n, bool with_checksum = false) {
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {16, 32, 48}, sizes = hsize_t(n);
    H5Pset_chunk(made, 3, chunk), H5Pset_shuffle(made), H5Pset_deflate(made, 1);
    if (with_checksum) H5Pset_fletcher32(made);
    Hdf5(path).dataset("v", {sizes, sizes, sizes}, voxels, made);
    H5Pclose(made);
}

/// Level 0 of a source, against the first value of each voxel of the whole volume; and every second voxel.
void expect_voxels(const std::string& name, const ReadOptions& options = {}) {
    Progress progress;
    const auto source = open_brick_source(name, options);
    ASSERT_TRUE(source) << name;
    const Volume whole = read_volume(name, options, progress), read = read_level(*source, 0, progress);
    ASSERT_EQ(read.dimensions, whole.dimensions);
    EXPECT_EQ(source->header().geometry, whole.geometry);
    ASSERT_EQ(read.type, whole.type);
    const std::size_t size = size_of(whole.type), stride = size * std::size_t(whole.components);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < whole.voxel_count(); ++i)
        wrong += std::memcmp(read.voxels.data() + i * size, whole.voxels.data() + i * stride, size) != 0;
    EXPECT_EQ(wrong, 0u) << name;
    if (source->levels().size() < 2) return;
    const auto [nx, ny, nz] = source->levels()[1].dimensions;
    const Volume half = read_level(*source, 1, progress);
    const auto at = [&](int x, int y, int z) {
        const auto [wide, high, deep] = whole.dimensions;
        return std::size_t((z * high + y) * wide + x);
    };
    for (int z = 0, i = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x, ++i)
                wrong += std::memcmp(half.voxels.data() + std::size_t(i) * size,
                                     whole.voxels.data() + at(2 * x + 1, 2 * y + 1, 2 * z + 1) * stride, size) != 0;
    EXPECT_EQ(wrong, 0u) << name << " at level 1";
}

/// What is said when all of level 0 is read by bricks, or as a whole where it is not; "" where it is read.
std::string said_of(const std::string& name) {
    Progress progress;
    try {
        if (const auto source = open_brick_source(name, {}))
            read_level(*source, 0, progress);
        else
            read_volume(name, {}, progress);
        return {};
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
        return error.what();
    }
}

}  // namespace

TEST_F(Chunks, PicturesOfTiffStacksAreThoseOfTheWholeVolumeBitForBit) {
    const std::string name = (folder / "a.tif").string();
    for (const TiffStorage& storage : {tiles, small_tiles, strips, whole_pages}) {
        write_stack(name, storage, voxels, {n, n, n});
        expect_same_pictures(name, progress);
    }
}

TEST_F(Chunks, PicturesOfChunksWithChecksumsAreThoseOfTheWholeVolumeBitForBit) {
    write_chunked(folder / "a.h5", voxels, n, true);
    expect_same_pictures((folder / "a.h5").string(), progress);
}

TEST(ChunkFormats, TiffOfEveryKindIsReadByBricksAsItIsAsAWhole) {
    const Folder folder;
    const std::array n{97, 75, 66};
    const std::string name = (folder / "a.tif").string();
    std::vector<std::uint16_t> numbers(std::size_t(n[0] * n[1] * n[2]));
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = std::uint16_t(i * 2654435761u >> 13);
    for (const TiffStorage& storage : {tiles, small_tiles, strips, whole_pages}) {
        write_stack(name, storage, numbers, n);
        expect_voxels(name);
    }
    for (const bool planes : {false, true})
        for (const bool tiled : {false, true}) {
            write_tiff<std::uint8_t>(
                name, {.tiled = tiled, .planes = planes, .samples = 3}, n,
                [](int x, int y, int z, int s) { return std::uint8_t(x + 3 * y + 5 * z + 70 * s); });
            expect_voxels(name);
            const auto notes = open_brick_source(name, {})->header().notes;
            EXPECT_TRUE(std::ranges::any_of(
                notes, [](auto& note) { return note == "by bricks the first of 3 values a voxel is shown"; }));
        }
    for (const bool big_endian : {false, true}) {  // one directory for all slices
        const std::string all = bytes_of_all(numbers, big_endian);
        const std::size_t page = std::size_t(n[0] * n[1]) * 2;
        const TiffImage first{.pixels = all.substr(0, page),
                              .columns = n[0],
                              .rows = n[1],
                              .description = "ImageJ=1.53t\nimages=66\nslices=66\n"};
        folder.write("a.tif", tiff_file({first}, big_endian, all.substr(page)));
        expect_voxels(name);
    }
}

TEST(ChunkFormats, MomentsChannelsAndFoldersOfTiffAreReadByBricks) {
    const Folder folder;
    std::vector<TiffImage> pages;
    for (int i = 0; i < 12; ++i)
        pages.push_back({.pixels = bytes_of_all(ramp<std::uint16_t>(12, std::uint16_t(100 * i)))});
    pages[0].description = "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n";
    const std::string name = folder.write("a.tif", tiff_file(pages));
    for (const int time : {0, 1}) expect_voxels(name, {.time = time});
    EXPECT_FALSE(open_brick_source(name, {.time = 2})) << "which reading it says";
    const auto source = open_brick_source(name, {.time = 1});
    EXPECT_EQ(source->header().moments.count, 2);
    EXPECT_EQ(voxels_in<std::uint16_t>(*source, 0, {{1, 0, 2}, {1, 1, 1}})[0], 1001);
    const std::string ome = folder.write("c/c1.tif", ome_file());  // its channels lie in two files
    folder.write("c/c2.tif", tiff_file({pages[5]}));
    expect_voxels(ome);
    for (int i = 0; i < 3; ++i) folder.write(fmt::format("b/s{}.tif", 9 + i), tiff_file({pages[std::size_t(i) + 1]}));
    expect_voxels((folder / "b").string());
    EXPECT_FALSE(open_brick_source((folder / "b").string(), {.time = 1}));
    Hdf5(folder / "a.h5").dataset("v", {2, 3, 4}, ramp<std::uint16_t>(24));
    EXPECT_FALSE(open_brick_source((folder / "a.h5").string(), {.time = 1})) << "there is one moment";
}

TEST(ChunkFormats, Hdf5OfAnyChunksIsReadByBricksAsItIsAsAWhole) {
    const Folder folder;
    const std::vector<hsize_t> sizes{45, 50, 70};
    const auto numbers = ramp<std::uint16_t>(45 * 50 * 70, 9);
    const std::string name = (folder / "a.h5").string();
    for (const auto& chunk : {std::array<hsize_t, 3>{8, 8, 8}, {1, 20, 30}, {9, 33, 5}, {45, 50, 70}})
        for (const bool with_checksum : {false, true}) {
            const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
            H5Pset_chunk(made, 3, chunk.data()), H5Pset_deflate(made, 1);
            if (with_checksum) H5Pset_fletcher32(made);
            Hdf5(name).dataset("v", sizes, numbers, made);
            H5Pclose(made);
            expect_voxels(name);
        }
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);  // moments before, channels behind
    const hsize_t chunk[] = {2, 8, 9, 16, 2};
    H5Pset_chunk(made, 5, chunk), H5Pset_fletcher32(made);
    Hdf5(name)
        .dataset("v", {3, 21, 23, 20, 3}, ramp<std::uint16_t>(3 * 21 * 23 * 20 * 3), made)
        .text("axistags", axistags("tzyxc"));
    H5Pclose(made);
    for (const int time : {0, 1, 2}) expect_voxels(name, {.time = time});
}

// Of 4 x 4 x 4 chunks of 8³ two were written, which one that is asked for has together.
TEST(ChunkFormats, ChunksThatWereNeverWrittenHoldTheFillValue) {
    const Folder folder;
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {8, 8, 8}, sizes[] = {64, 64, 64};
    const std::uint16_t fill = 77;
    H5Pset_chunk(made, 3, chunk), H5Pset_fill_value(made, H5T_NATIVE_UINT16, &fill);
    {
        const Hdf5 file(folder / "a.h5");
        const hid_t space = H5Screate_simple(3, sizes, nullptr),
                    data = H5Dcreate2(file.file(), "v", H5T_NATIVE_UINT16, space, H5P_DEFAULT, made, H5P_DEFAULT);
        const auto numbers = ramp<std::uint16_t>(512, 1000);
        for (const hsize_t z : {8, 24}) {
            const hsize_t at[] = {z, 16, 0};
            H5Dwrite_chunk(data, H5P_DEFAULT, 0, at, 1024, numbers.data());
        }
    }
    expect_voxels((folder / "a.h5").string());
}

TEST_F(Chunks, OnlyWhatIsAskedForIsDecodedAndOnce) {
    write_stack((folder / "tiles.tif").string(),
                {.compression = COMPRESSION_LZW, .tiled = true, .columns = 64, .rows = 64}, voxels, {n, n, n});
    write_stack((folder / "strips.tif").string(), strips, voxels, {n, n, n});
    write_chunked(folder / "chunks.h5", voxels, n);
    const CountingDecoder decoder(folder);
    const struct {
        const char* file;
        std::size_t chunks, of_a_quarter, around_a_voxel;  ///< of all; of level 2; of a box of 35³ at the corner
    } cases[] = {{"tiles.tif", 4 * 128, 4 * 32, 35}, {"strips.tif", 4 * 128, 4 * 32, 35}, {"chunks.h5", 48, 48, 4}};
    for (const auto& [file, chunks, of_a_quarter, around_a_voxel] : cases) {
        SCOPED_TRACE(file);
        const auto fresh = [&] {
            const auto source = open_brick_source((folder / file).string(), {});
            EXPECT_TRUE(decoder.asked().empty()) << "nothing is decoded before it is asked for";
            return source;
        };
        const auto expect_each_once = [&](std::size_t count) {
            const auto asked = decoder.asked();
            EXPECT_EQ(asked.size(), count);
            EXPECT_EQ(std::set(asked.begin(), asked.end()).size(), count);
        };
        read_level(*fresh(), 2, progress);
        expect_each_once(of_a_quarter);
        read_level(*fresh(), 0, progress);
        expect_each_once(chunks);
        voxels_in<float>(*fresh(), 0, {{0, 0, 0}, {35, 35, 35}});
        expect_each_once(around_a_voxel);
    }
}

TEST_F(Chunks, ADamagedChecksumIsOneChunksFault) {
    write_chunked(folder / "a.h5", voxels, n, true);
    std::string bytes = content_of(folder / "a.h5");
    bytes[bytes.size() / 2] ^= 0x55;  // among the values
    const std::string name = folder.write("b.h5", bytes);
    const auto source = open_brick_source(name, {});
    ASSERT_TRUE(source) << "which reads no values";
    EXPECT_EQ(voxels_in<float>(*source, 0, {{0, 0, 0}, {1, 1, 1}})[0], -300);
    EXPECT_NE(said_of(name).find("damaged or missing"), std::string::npos);
}

TEST(ChunkFormats, PagesOfOtherStripsThanTheFirstOnesAreReadAsTheyAre) {
    const Folder folder;
    std::vector<std::uint16_t> numbers = ramp<std::uint16_t>(97 * 75);
    for (int i = 0; i < 4; ++i) {
        const std::string name = (folder / fmt::format("s/{}.tif", i)).string();
        fs::create_directories(folder / "s");
        write_stack(name, i % 2 ? strips : tiles, numbers, {97, 75, 1});
        std::ranges::reverse(numbers);
    }
    expect_voxels((folder / "s").string());
}

TEST_F(Chunks, FilesThatAreCutOrChangedWhileTheyAreServedAreTold) {
    for (const TiffStorage& storage : {tiles, strips}) {
        const std::string name = (folder / "a.tif").string();
        write_stack(name, storage, voxels, {n, n, n});
        const auto source = open_brick_source(name, {});
        EXPECT_EQ(voxels_in<float>(*source, 0, {{0, 0, 0}, {1, 1, 1}})[0], -300);
        fs::resize_file(name, fs::file_size(name) / 2);
        try {
            voxels_in<float>(*source, 0, {{0, 0, 120}, {1, 1, 1}});
            ADD_FAILURE() << "the page is not there";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input);
            EXPECT_EQ(std::string(error.what()).find("crashed"), std::string::npos) << error.what();
        }
        EXPECT_EQ(voxels_in<float>(*source, 0, {{64, 64, 2}, {1, 1, 1}})[0],
                  voxels[std::size_t((2 * n + 64) * n + 64)]);
    }
}

// Level 0 by bricks, of each file cut at and flipped in many places: every end is voxels or a sentence.
TEST(ChunkFormats, DamagedFilesEndInASentence) {
    const Folder folder;
    const std::array n{50, 41, 9};
    const auto numbers = ramp<std::uint16_t>(std::size_t(n[0] * n[1] * n[2]));
    std::vector<std::string> files;
    for (const TiffStorage& storage : {tiles, small_tiles, strips}) {
        files.push_back(fmt::format("{}.tif", files.size()));
        write_stack((folder / files.back()).string(), storage, numbers, n);
    }
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {4, 16, 16};
    H5Pset_chunk(made, 3, chunk), H5Pset_deflate(made, 6);
    Hdf5(folder / "a.h5").dataset("v", {9, 41, 50}, numbers, made);
    H5Pclose(made);
    files.push_back("a.h5");
    for (const std::string& file : files) {
        const std::string whole = content_of(folder / file);
        EXPECT_EQ(said_of((folder / file).string()), "");
        std::size_t refused = 0;
        constexpr std::size_t places = 24;
        for (std::size_t i = 0; i < places; ++i) {
            const std::size_t at = whole.size() * i / places;
            std::string flipped = whole;
            flipped[at] = char(flipped[at] ^ (1 << i % 8)), flipped[at / 8] = char(flipped[at / 8] ^ (1 << i % 7));
            for (const std::string& bytes : {whole.substr(0, std::max<std::size_t>(at, 1)), flipped}) {
                const std::string said = said_of(folder.write("damaged" + file, bytes));
                for (const char* never : {"crashed", "halt", "more than 1", "\n"})
                    EXPECT_EQ(said.find(never), said.npos) << said;
                refused += !said.empty();
            }
        }
        EXPECT_GE(refused, places) << file << ": whatever is cut";
    }
}

namespace {
struct ChunkMemory : ToolTest {};
}  // namespace

// 128 MiB of voxels, of which a file takes less than one: that they are small on the disk counts for nothing.
TEST_F(ChunkMemory, OfPicturesStaysWithinTheBudgetAndThatOfADecoderFarBelowTheVolume) {
    const std::array n{512, 512, 256};
    const TiffValue<std::uint16_t> layers = [](int, int y, int z, int) { return std::uint16_t(y / 64 + z / 16); };
    write_tiff<std::uint16_t>((folder / "a.tif").string(),
                              {.compression = COMPRESSION_ADOBE_DEFLATE, .tiled = true, .columns = 128, .rows = 128}, n,
                              layers);
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {64, 64, 64};
    H5Pset_chunk(made, 3, chunk), H5Pset_deflate(made, 1);
    std::vector<std::uint16_t> voxels;
    for (int i = 0; i < n[0] * n[1] * n[2]; ++i) voxels.push_back(layers(0, i / n[0] % n[1], i / n[0] / n[1], 0));
    Hdf5(folder / "a.h5").dataset("v", {256, 512, 512}, voxels, made);
    H5Pclose(made);
    const auto peak = [&](const std::string& what) {
        const Said said =
            tool("render " + what + " -o p.png --size 400x300 --threads 2 --lighting none --stats s.json --quiet");
        EXPECT_EQ(said.code, 0) << said.err;
        return json("s.json")["peak_memory_bytes"].get<double>() / (1 << 20);
    };
    const double program = peak("sample:shells:8");
    const WrappedDecoder decoder(folder / "decode", "ulimit -v 65536\nexec");  // KiB of addresses
    for (const std::string file : {"a.tif", "a.h5"}) {
        EXPECT_LT(peak(file + " --memory 48M") - program, 48) << file;
        EXPECT_GT(json("s.json")["paging"]["bricks"], 100);
        EXPECT_NE(tool("render " + file + " --memory 8G -o p.png").code, 0) << "there is no room for it as a whole";
    }
}

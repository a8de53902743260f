// Stores that we write: what they hold, their levels, that a killed conversion goes on and ends in the same bytes, and
// that no changed byte goes unseen.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/zarr.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "core/atomic_file.h"
#include "core/crc32c.h"
#include "io/file_queue.h"
#include "tool_case.h"
#include "volume_files.h"

using namespace chiaro;
using namespace volume_files;

namespace {

Progress none;

template <class T>
Volume volume_of(std::array<int, 3> n, const std::function<T(int x, int y, int z)>& value) {
    Volume volume;
    volume.dimensions = n;
    volume.type = voxel_type_of<T>();
    volume.voxels = VoxelBuffer(volume.voxel_count() * sizeof(T));
    T* out = reinterpret_cast<T*>(volume.voxels.data());
    for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x) *out++ = value(x, y, z);
    volume.geometry.spacing_mm = {1, 1, 1};
    return volume;
}

std::map<std::string, std::string> files_in(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files[fs::relative(entry.path(), folder)] = content_of(entry.path());
    return files;
}

/// The names of what is not the same in both: where that is megabytes, nobody wants to see it.
std::string differences(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b) {
    std::string names;
    const auto compare = [&](const auto& from, const auto& with) {
        for (const auto& [name, bytes] : from) {
            const auto other = with.find(name);
            if (other == with.end() || other->second != bytes) names += name + '\n';
        }
    };
    compare(a, b), compare(b, a);
    return names;
}

/// What a level's voxel must be, found as simply as can be.
template <class T>
T coarser(const Volume& finer, std::array<int, 3> at, const std::array<int, 3>& factor, bool is_mean) {
    double sum = 0, largest = -INFINITY;
    int count = 0;
    for (int z = at[2] * factor[2]; z < std::min((at[2] + 1) * factor[2], finer.dimensions[2]); ++z)
        for (int y = at[1] * factor[1]; y < std::min((at[1] + 1) * factor[1], finer.dimensions[1]); ++y)
            for (int x = at[0] * factor[0]; x < std::min((at[0] + 1) * factor[0], finer.dimensions[0]); ++x) {
                const double value =
                    finer.as<T>()[(std::size_t(z) * finer.dimensions[1] + y) * finer.dimensions[0] + x];
                if (!std::isnan(value)) sum += value, largest = std::max(largest, value), ++count;
            }
    if (count == 0) return T(NAN);
    if (!is_mean) return T(largest);
    return std::is_integral_v<T> ? T(std::floor(sum / count + 0.5)) : T(sum / count);
}

template <class T>
void expect_pyramid(const Volume& volume, const ZarrSettings& settings) {
    const Folder folder;
    const fs::path store = folder / "a.zarr";
    Volume given;
    given.dimensions = volume.dimensions, given.type = volume.type, given.geometry = volume.geometry;
    given.voxels = VoxelBuffer::borrow(volume.voxels.data(), volume.voxels.size(), nullptr);
    write_zarr(*source_of(std::move(given)), store, settings, none);
    const auto source = open_brick_source(store.string(), {});
    ASSERT_TRUE(source);
    Volume finer = read_level(*source, 0, none);
    ASSERT_EQ(std::memcmp(finer.voxels.data(), volume.voxels.data(), volume.voxels.size()), 0);
    EXPECT_EQ(read(store).geometry, volume.geometry);
    ASSERT_GE(source->levels().size(), 2u);
    for (int level = 1; level < int(source->levels().size()); ++level) {
        if (*std::ranges::max_element(finer.dimensions) <= 64) break;  // the reader's own
        const Volume read = read_level(*source, level, none);
        std::array<int, 3> factor{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            factor[axis] = read.dimensions[axis] == finer.dimensions[axis] ? 1 : 2;
        for (int z = 0; z < read.dimensions[2]; z += 3)
            for (int y = 0; y < read.dimensions[1]; y += 2)
                for (int x = 0; x < read.dimensions[0]; ++x) {
                    const T got = read.as<T>()[(std::size_t(z) * read.dimensions[1] + y) * read.dimensions[0] + x];
                    const T want = coarser<T>(finer, {x, y, z}, factor, settings.levels_by == LevelsBy::mean);
                    ASSERT_TRUE(got == want || (got != got && want != want))
                        << level << ": " << x << ' ' << y << ' ' << z << ": " << +got << ", not " << +want;
                }
        const Vec3 centre = read.geometry.world_from_voxel({0, 0, 0}),
                   expected = finer.geometry.world_from_voxel(
                       {(factor[0] - 1) / 2., (factor[1] - 1) / 2., (factor[2] - 1) / 2.});
        EXPECT_LT(length(centre - expected), 1e-9);
        finer = read_level(*source, level, none);
    }
}

}  // namespace

TEST(ZarrWrite, LevelsAreMeansOrMaximaOfTheFiner) {
    for (const auto by : {LevelsBy::mean, LevelsBy::max})
        for (const auto encoding : {ZarrEncoding::raw, ZarrEncoding::zstd, ZarrEncoding::blosc}) {
            const ZarrSettings settings{encoding, by};
            expect_pyramid<std::uint8_t>(
                volume_of<std::uint8_t>({131, 70, 67}, [](int x, int y, int z) { return x * y + z * 7; }), settings);
            expect_pyramid<std::int16_t>(
                volume_of<std::int16_t>({90, 140, 33}, [](int x, int y, int z) { return x * 300 - y * 211 + z; }),
                settings);
            expect_pyramid<float>(
                volume_of<float>(
                    {70, 66, 130},
                    [](int x, int y, int z) { return (x / 9 + y / 9 + z / 9) % 3 ? std::sin(float(x * y - z)) : NAN; }),
                settings);
        }
}

TEST(ZarrWrite, TheUsualEncodingIsByTheWidthOfTheNumbers) {
    const auto codec = [](Volume volume) {
        const Folder folder;
        write_zarr(*source_of(std::move(volume)), folder / "a.zarr", {}, none);
        return nlohmann::json::parse(
            content_of(folder / "a.zarr/0/zarr.json"))["codecs"][0]["configuration"]["codecs"][1];
    };
    const auto zero = [](int, int, int) { return 0; };
    EXPECT_EQ(codec(volume_of<std::uint8_t>({9, 9, 9}, zero))["name"], "zstd");
    EXPECT_EQ(codec(volume_of<std::int16_t>({9, 9, 9}, zero))["configuration"]["shuffle"], "bitshuffle");
    EXPECT_EQ(
        codec(volume_of<float>({9, 9, 9}, zero))["configuration"],
        nlohmann::json::parse(R"({"cname": "lz4", "clevel": 9, "shuffle": "shuffle", "typesize": 4, "blocksize": 0})"));
}

TEST(ZarrWrite, GeometryAndValuesAreThoseOfTheInput) {
    Volume volume = volume_of<std::uint16_t>({100, 90, 20}, [](int x, int y, int z) { return x + 300 * y + z; });
    volume.geometry.spacing_mm = {0.5, 0.5, 2};
    volume.geometry.origin_mm = {-10, 20, 3};
    volume.geometry.direction = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
    volume.geometry.world = World::lps;
    volume.slope = 2, volume.intercept = -1024, volume.modality = "CT";
    const Folder folder;
    expect_pyramid<std::uint16_t>(volume, {});
    write_zarr(*source_of(std::move(volume)), folder / "a.zarr", {}, none);
    const Volume back = read(folder / "a.zarr");
    EXPECT_EQ(back.slope, 2);
    EXPECT_EQ(back.intercept, -1024);
    EXPECT_EQ(back.modality, "CT");
    EXPECT_EQ(back.geometry.world, World::lps);
}

TEST(ZarrWrite, ACutOrFlippedByteIsFound) {
    const Folder folder;
    const fs::path store = folder / "a.zarr", shard = store / "0/c/0/0/0";
    write_zarr(*source_of(make_sample("shells", 80, none)), store, {}, none);
    const std::string whole = content_of(shard);
    std::mt19937 random(5);
    for (int i = 0; i < 40; ++i) {
        std::string damaged = whole;
        if (i % 4 == 0)
            damaged.resize(random() % damaged.size());
        else
            damaged[random() % damaged.size()] ^= char(1 << random() % 8);
        folder.write("a.zarr/0/c/0/0/0", damaged);
        EXPECT_THROW(read(store), Error) << i;
    }
    folder.write("a.zarr/0/c/0/0/0", whole);
    EXPECT_EQ(read(store).voxels.size(), make_sample("shells", 80, none).voxels.size());
}

TEST(ZarrWrite, NothingIsOverwrittenOrTakenForAnotherVolume) {
    const Folder folder;
    const fs::path store = folder / "a.zarr";
    const auto source = source_of(make_sample("ball", 40, none));
    const auto sentence = [&](const ZarrSettings& settings) {
        try {
            write_zarr(*source, store, settings, none);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::output);
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(sentence({}), "");
    EXPECT_NE(sentence({}).find("is there already"), std::string::npos);
    fs::remove_all(store);
    Progress cancelled;
    cancelled.cancel();
    EXPECT_THROW(write_zarr(*source, store, {}, cancelled), Error);
    try {
        read(store);
        ADD_FAILURE() << "half a store is none";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("may have been interrupted"), std::string::npos) << error.what();
    }
    EXPECT_NE(sentence({ZarrEncoding::raw}).find("another conversion"), std::string::npos);
    fs::remove_all(store / "0");  // as if it were broken off before
    EXPECT_EQ(sentence({}), "");
    EXPECT_NO_THROW(read(store));
}

TEST(ZarrWrite, ChecksumsAreThoseOfTheStandardByEitherWay) {
    const std::string known = "123456789";  // whose sum is told wherever checksums are
    EXPECT_EQ(crc32c(std::as_bytes(std::span(known))), 0xe3069283);
    std::mt19937 random(7);
    std::vector<std::byte> bytes(3000);
    for (std::byte& b : bytes) b = std::byte(random());
    for (std::size_t first = 0; first < 9; ++first)
        for (const std::size_t size : {0, 1, 7, 8, 9, 255, 2048, 2991}) {
            const auto part = std::span(bytes).subspan(first, size);
            EXPECT_EQ(crc32c(part), crc32c_by_tables(part)) << first << ' ' << size;
        }
}

TEST(ZarrWrite, FilesPastTheCacheHoldWhatTheyWereGiven) {
    const Folder folder;
    VoxelBuffer bytes(1 << 20);
    std::mt19937 random(3);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes.data()[i] = std::byte(random());
    for (const std::size_t size : {0, 1, 4095, 4096, 4097, 300000, 1 << 20}) {
        AtomicFile file(folder / "a");
        file.write_past_cache({bytes.data(), size});
        file.write(std::as_bytes(std::span("behind", 6)));
        file.commit();
        EXPECT_TRUE(content_of(folder / "a") == std::string(reinterpret_cast<char*>(bytes.data()), size) + "behind");
    }
}

TEST(ZarrWrite, ANewFileNeverHasAnotherName) {
    const Folder folder;
    const int seen = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    ASSERT_GE(inotify_add_watch(seen, std::string(folder / ".").c_str(), IN_CREATE | IN_MOVE), 0);
    const auto names = [&] {
        alignas(inotify_event) char events[4096];
        std::vector<std::string> told;
        const ssize_t size = read(seen, events, sizeof events);
        for (ssize_t at = 0; at < size;) {
            const auto& event = *reinterpret_cast<const inotify_event*>(events + at);
            told.emplace_back(event.name);
            at += ssize_t(sizeof event + event.len);
        }
        return told;
    };
    const auto write = [&](const char* text) {
        AtomicFile file(folder / "a");
        file.write(std::as_bytes(std::span(text, 5)));
        file.commit();
        EXPECT_EQ(content_of(folder / "a"), text);
    };
    write("first");
    const auto first = names();
    if (first.size() > 1) GTEST_SKIP() << "skipped: this file system has no files without a name";
    EXPECT_EQ(first, std::vector<std::string>{"a"});
    write("again");
    EXPECT_EQ(names().size(), 3u);  // a temporary name, and the change from it to its own
    close(seen);
}

TEST(ZarrWrite, FilesTakeTheirNamesInTurnAndNoneBehindOneThatFails) {
    const Folder folder;
    folder.write("file", "in the way");
    constexpr std::size_t size = 100000;
    const auto write = [&](FileQueue& queue, const std::string& name) {
        VoxelBuffer bytes = queue.room();
        std::memset(bytes.data(), name[0], size);
        queue.write(folder / name, std::move(bytes), size);
    };
    {
        FileQueue queue(size);
        for (char c = 'a'; c <= 'z'; ++c) write(queue, std::string(1, c) + "/1");
        queue.finish();
        for (char c = 'a'; c <= 'z'; ++c)
            EXPECT_TRUE(content_of(folder / (std::string(1, c) + "/1")) == std::string(size, c)) << c;
    }
    FileQueue queue(size);
    write(queue, "first");
    EXPECT_THROW(
        {
            write(queue, "file/cannot be");
            for (int i = 0; i < 9; ++i) write(queue, "later" + std::to_string(i));
        },
        std::exception);
    EXPECT_THROW(queue.finish(), std::exception);
    EXPECT_TRUE(fs::exists(folder / "first"));
    EXPECT_FALSE(fs::exists(folder / "later0"));
}

namespace {

/// Of the bytes of all files of voxels.
std::uint32_t sum_of(const fs::path& store) {
    std::string all;
    for (const auto& [name, bytes] : files_in(store))
        if (name.find("/c/") != name.npos) all += name + bytes;
    return crc32c(std::as_bytes(std::span(all)));
}

}  // namespace

TEST(ZarrWrite, TheSameVoxelsAreTheSameBytesEver) {
    const Folder folder;
    const auto sum = [&](Volume volume, LevelsBy by) {
        fs::remove_all(folder / "a.zarr");
        write_zarr(*source_of(std::move(volume)), folder / "a.zarr", {ZarrEncoding::raw, by}, none);
        return sum_of(folder / "a.zarr");
    };
    const auto hash = [](int x, int y, int z) { return (x * 73856093u ^ y * 19349663u ^ z * 83492791u) * 2654435761u; };
    const auto floats = [&](int x, int y, int z) {
        const std::uint32_t h = hash(x, y, z);
        return h % 5 == 0 || z < 9 ? NAN : float(h >> 8) / 77.F * (h & 1 ? -1.F : 1e-5F);
    };
    const auto bytes = [&](int x, int y, int z) { return std::uint8_t(hash(x, y, z) >> 24); };
    const auto shorts = [&](int x, int y, int z) { return std::int16_t(hash(x, y, z) >> 16); };
    const std::array large{1100, 71, 67}, odd{67, 300, 131};
    EXPECT_EQ(sum(volume_of<std::uint8_t>(large, bytes), LevelsBy::mean), 3635113374u);
    EXPECT_EQ(sum(volume_of<std::uint8_t>(odd, bytes), LevelsBy::max), 2765817993u);
    EXPECT_EQ(sum(volume_of<std::int16_t>(odd, shorts), LevelsBy::mean), 1584962974u);
    EXPECT_EQ(sum(volume_of<float>(odd, floats), LevelsBy::mean), 1289719666u);
    EXPECT_EQ(sum(volume_of<float>(large, floats), LevelsBy::max), 2228220155u);
}

namespace {
using Convert = ToolTest;
}  // namespace

TEST_F(Convert, KilledAtAnyMomentItGoesOnAndEndsInTheSameBytes) {
    ASSERT_EQ(tool("convert sample:shells:330 whole.zarr").code, 0);
    const auto whole = files_in(folder / "whole.zarr");
    EXPECT_GT(whole.size(), 20u);
    int killed = 0;
    for (int i = 0; i < 10; ++i) {
        const auto is_whole = [&] { return std::filesystem::exists(folder / "a.zarr/zarr.json"); };
        for (int again = 0; again <= i % 3 && !is_whole(); ++again) {
            tool("convert sample:shells:330 a.zarr", SIGKILL, std::chrono::milliseconds(20 + 40 * i));
            killed += !is_whole();
        }
        if (!is_whole()) {
            const Said said = tool("convert sample:shells:330 a.zarr");
            ASSERT_EQ(said.code, 0) << said.err;
        }
        EXPECT_EQ(differences(files_in(folder / "a.zarr"), whole), "");
        std::filesystem::remove_all(folder / "a.zarr");
    }
    EXPECT_GT(killed, 3);
    const Said pictures = tool("render whole.zarr --memory 64M --size 200x150 -o a.png --stats a.json");
    ASSERT_EQ(pictures.code, 0) << pictures.err;
    EXPECT_GE(json("a.json")["paging"]["levels"], 3);
}

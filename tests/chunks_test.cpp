// Bricks of what is kept in chunks: those of the whole volume; and what becomes of a decoder that crashes, hangs or is
// left alone.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <sys/wait.h>

#include <thread>

#include "chunk_case.h"
#include "hdf5_files.h"
#include "zarr_files.h"

using namespace chiaro;
using namespace volume_files;

namespace {

/// Every second voxel, from the second on.
template <class T>
std::vector<T> halved(const std::vector<T>& voxels, int n) {
    std::vector<T> half;
    for (int z = 1; z < n; z += 2)
        for (int y = 1; y < n; y += 2)
            for (int x = 1; x < n; x += 2) half.push_back(voxels[std::size_t((z * n + y) * n + x)]);
    return half;
}

std::string dataset(const std::string& path, int scale, double translation) {
    return fmt::format(R"({{"path": "{}", "coordinateTransformations": [{{"type": "scale", "scale": [{}, {}, {}]}},
                       {{"type": "translation", "translation": [{}, {}, {}]}}]}})",
                       path, scale, scale, scale, translation, translation, translation);
}

/// A store of two levels.
void write_levels(const Folder& folder, const std::vector<float>& voxels, int n) {
    const ZarrLayout layout{
        .shape = {n, n, n}, .chunk = {40, 30, 50}, .version = 3, .codec = "gzip", .shard = {80, 60, 50}};
    ZarrLayout half = layout;
    half.shape = {n / 2, n / 2, n / 2}, half.shard = {};
    write_zarr(folder, "a/s0", layout, voxels);
    write_zarr(folder, "a/s1", half, halved(voxels, n));
    folder.write("a/zarr.json",
                 R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.5", "multiscales": [{
                     "axes": [{"name": "z", "type": "space", "unit": "millimeter"},
                              {"name": "y", "type": "space", "unit": "millimeter"},
                              {"name": "x", "type": "space", "unit": "millimeter"}], "datasets": [)" +
                     dataset("s0", 1, 0) + ", " + dataset("s1", 2, 1) + "]}]}}}");
}

/// How many processes were started with this word, beside zombies.
int processes_with(const std::string& word) {
    int count = 0;
    for (const auto& entry : fs::directory_iterator("/proc"))
        count += content_of(entry.path() / "cmdline").find(word) != std::string::npos;
    return count;
}

std::size_t open_descriptors() { return std::size_t(std::distance(fs::directory_iterator("/proc/self/fd"), {})); }

}  // namespace

TEST_F(Chunks, OfOmeZarrLevelsAreItsOwnAndThenEverySecondVoxelOfTheLast) {
    write_levels(folder, voxels, n);
    const std::string name = (folder / "a").string();
    const auto source = open_brick_source(name, {});
    ASSERT_TRUE(source);
    ASSERT_EQ(source->levels().size(), 3u) << "128, 64, 32";
    const auto half = halved(voxels, n);
    const std::vector<float> all[] = {voxels, half, halved(half, n / 2)};
    for (int level = 0; level < 3; ++level) {
        const Volume read = read_level(*source, level, progress);
        const auto& expected = all[std::size_t(level)];
        EXPECT_EQ(read.dimensions[0], n >> level);
        EXPECT_EQ(std::memcmp(read.voxels.data(), expected.data(), read.voxels.size()), 0) << level;
    }
    EXPECT_EQ(source->levels()[1].geometry.origin_mm, (Vec3{1, 1, 1}));
    EXPECT_EQ(source->levels()[2].geometry.spacing_mm, (Vec3{4, 4, 4}));
    EXPECT_EQ(source->levels()[2].geometry.origin_mm, (Vec3{3, 3, 3}));
    EXPECT_EQ(voxels_in<float>(*source, 2, {{5, 6, 7}, {2, 2, 2}})[7], all[2][(8 * 32 + 7) * 32 + 6]);
    EXPECT_EQ(voxels_in<float>(*source, 0, {{39, 59, 99}, {3, 3, 3}})[26], voxels[(101 * 128 + 61) * 128 + 41]);
}

TEST_F(Chunks, PicturesAreThoseOfTheWholeVolumeBitForBit) {
    write_levels(folder, voxels, n);
    expect_same_pictures((folder / "a").string(), progress);
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {40, 30, 50};
    H5Pset_chunk(made, 3, chunk), H5Pset_deflate(made, 1);
    Hdf5(folder / "a.h5").dataset("v", {n, n, n}, voxels, made);
    H5Pclose(made);
    expect_same_pictures((folder / "a.h5").string(), progress);
    Hdf5(folder / "b.h5").dataset("v", {n, n, n}, voxels);
    expect_same_pictures((folder / "b.h5").string(), progress);
}

TEST_F(Chunks, WhatIsDecodedIsKeptWithinTheBudget) {
    write_levels(folder, voxels, n);
    const auto source = open_brick_source((folder / "a").string(), {});
    EXPECT_EQ(source->keep_decoded(1 << 20), std::size_t(1) << 20);
    EXPECT_EQ(source->keep_decoded(std::size_t(1) << 40), std::size_t(256) << 20) << "no more than it ever takes";
    EXPECT_EQ(source->keep_decoded(1), 1u);
    EXPECT_EQ(voxels_in<float>(*source, 0, {{39, 59, 99}, {3, 3, 3}})[26], voxels[(101 * 128 + 61) * 128 + 41]);
    EXPECT_EQ(open_brick_source("sample:ball:64", {})->keep_decoded(1 << 20), 0u);
    EXPECT_FALSE(source->is_far());
}

TEST_F(Chunks, OneThatVanishesOrIsDamagedIsToldAndStoodFor) {
    write_levels(folder, voxels, n);
    Session session(Device::cpu(2));
    session.show(open_brick_source((folder / "a").string(), {}), {.memory_bytes = 20 << 20}, progress);
    fs::resize_file(folder / "a/s0/0.1.1", 50);
    const auto drawn = picture(session, progress);
    const auto notes = session.notes();
    EXPECT_TRUE(std::ranges::any_of(notes, [](auto& note) { return note.find("less than its index") != note.npos; }));
    EXPECT_TRUE(std::ranges::any_of(notes, [](auto& note) { return note.find("bricks cannot be read") != note.npos; }));
    EXPECT_GT(*std::ranges::max_element(drawn), 100);
}

namespace {

/// A decoder that does what the file says at the last of eight chunks.
struct BadDecoder : Chunks {
    void SetUp() override { setenv("CHIARO_DECODE", built("misbehaving_decoder").c_str(), 1); }
    void TearDown() override { unsetenv("CHIARO_DECODE"); }
    std::shared_ptr<const BrickSource> source(const std::string& deed) {
        ReadOptions options;
        options.stall_seconds = 2;
        return open_brick_source(folder.write("task.h5", deed + "\n"), options);
    }
    static int value_at(const BrickSource& source, int x, int y, int z) {
        return voxels_in<std::uint8_t>(source, 0, {{x, y, z}, {1, 1, 1}})[0];
    }
    static std::string fault_at(const BrickSource& source, int x, int y, int z) {
        try {
            value_at(source, x, y, z);
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    }
};

}  // namespace

TEST_F(BadDecoder, ThatCrashesOrHangsLosesOneChunkAndIsStartedAgain) {
    for (const std::string deed : {"crash", "abort", "sleep", "spin"}) {
        const auto source = this->source(deed);
        ASSERT_TRUE(source);
        EXPECT_EQ(value_at(*source, 40, 0, 0), 1);
        const std::string fault = fault_at(*source, 40, 40, 40);
        EXPECT_NE(fault.find(deed == "crash" || deed == "abort" ? "crashed" : "more than"), fault.npos) << fault;
        EXPECT_EQ(fault_at(*source, 50, 50, 50), fault) << "the same chunk, of which it is not asked again";
        EXPECT_EQ(value_at(*source, 0, 40, 40), 6);
        EXPECT_LE(processes_with("task.h5"), 8);
    }
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a zombie";
}

TEST_F(BadDecoder, ThatHangsKeepsNobodyWaitingWhoIsCancelled) {
    ReadOptions options;
    options.stall_seconds = options.seconds = 1e6;  // were it these limits that end it, the test would never
    const auto source = open_brick_source(folder.write("task.h5", "sleep\n"), options);
    ASSERT_TRUE(source);
    std::thread cancelling([&] {
        while (processes_with("task.h5") < 1) usleep(1000);
        usleep(100000);
        progress.cancel();
    });
    try {
        read_level(*source, 0, progress);
        ADD_FAILURE() << "nothing was cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::interrupted);
    }
    cancelling.join();
    EXPECT_EQ(value_at(*source, 40, 0, 0), 1) << "others are still read";
}

TEST_F(BadDecoder, OutlivesTheThreadThatAskedFirst) {
    const auto source = this->source("nothing");
    std::thread([&] { EXPECT_EQ(value_at(*source, 40, 0, 0), 1); }).join();
    EXPECT_EQ(value_at(*source, 0, 0, 40), 4);
}

TEST_F(BadDecoder, EndsWithThisProcessHoweverThatEnds) {
    const std::string file = (folder / "task.h5").string();
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
        const auto source = this->source("spin");
        const char word = char(value_at(*source, 40, 0, 0));
        [[maybe_unused]] const auto written = write(ready[1], &word, 1);
        fault_at(*source, 40, 40, 40);  // busy for longer than we wait
        _exit(0);
    }
    char word = 0;
    ASSERT_EQ(::read(ready[0], &word, 1), 1);
    EXPECT_EQ(word, 1);
    EXPECT_GT(processes_with(file), 0);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    for (int i = 0; i < 6000 && processes_with(file) > 0; ++i) usleep(10000);
    EXPECT_EQ(processes_with(file), 0);
    close(ready[0]), close(ready[1]);
}

TEST_F(BadDecoder, LeavesNothingBehind) {
    source("nothing");
    const std::size_t before = open_descriptors();
    for (int i = 0; i < 50; ++i) EXPECT_EQ(value_at(*source("nothing"), 40, 40, 0), 3);
    EXPECT_EQ(open_descriptors(), before);
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
}

// Sessions and the tool on volumes by bricks: what they show, and tell.
#include <chiaro/samples.h>
#include <chiaro/session.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "tool_case.h"

using namespace chiaro;

namespace {

/// A session of a volume by bricks.
struct PagedSession : ::testing::Test {
    Progress progress{};
    Scene scene = scene_of_volume("sample:shells:224");

    void SetUp() override {
        scene.width = 80, scene.height = 60;
        scene.camera.fit = Fit::volume;
        scene.camera.zoom = 6;
        scene.interpolation = Interpolation::linear;
        scene.illumination.method = Method::none;
    }
    std::vector<std::uint8_t> picture(Session& session) {
        const Image& image = session.render(scene, progress);
        return image.pixels;
    }
};

constexpr std::uint64_t mebibyte = 1 << 20;

}  // namespace

TEST_F(PagedSession, ShowsWhatAWholeOneDoes) {
    const auto source = open_sample("shells", 224);
    const PagingSettings settings{.memory_bytes = 36 * mebibyte};
    EXPECT_FALSE(fits(*source, settings));
    EXPECT_TRUE(fits(*source, {.memory_bytes = 64 * mebibyte}));
    Session paged(Device::cpu(2)), whole(Device::cpu(2));
    paged.show(source, settings, progress);
    whole.show(make_sample("shells", 224), progress);
    EXPECT_EQ(picture(paged), picture(whole));
    ASSERT_TRUE(paged.paging());
    EXPECT_EQ(paged.paging()->level, 0);
    EXPECT_EQ(paged.paging()->light_level, 1);
    EXPECT_EQ(paged.paging()->stopped_by, "volume");
    EXPECT_FALSE(whole.paging());
    scene.camera.azimuth_deg = 80;
    EXPECT_EQ(picture(paged), picture(whole)) << "after a turn, with bricks of the last picture";
    scene.transfer.opacity_scale = 0.1;
    EXPECT_EQ(picture(paged), picture(whole)) << "after an edit";
}

/// Of what has been read drafts are drawn, by all sessions that share the volume.
TEST_F(PagedSession, DraftsShowWhatHasBeenRead) {
    Session paged(Device::cpu(2));
    paged.show(open_sample("shells", 224), {.memory_bytes = 36 * mebibyte}, progress);
    const auto draft = [&](Session& session) { return std::vector(session.preview(scene, progress).pixels); };
    const auto coarse = draft(paged), fine = picture(paged);
    EXPECT_NE(coarse, fine) << "nothing had been read";
    EXPECT_EQ(draft(paged), fine);
    Session other = paged.share_volume();
    EXPECT_EQ(draft(other), fine);
    EXPECT_FALSE(other.paging()) << "of renders alone";
    const std::size_t bricks_read = paged.paging()->bricks_read;
    EXPECT_EQ(picture(other), fine);
    EXPECT_LT(double(other.paging()->bricks_read), 1.2 * double(bricks_read)) << "what is there is not read again";
    EXPECT_EQ(other.finest().dimensions, (std::array{224, 224, 224}));
    EXPECT_TRUE(other.source());
    scene.camera.zoom = 0.3;
    const auto far = draft(paged);
    scene.transfer.opacity_scale = 0.2;
    EXPECT_NE(draft(paged), far) << "an edit is seen in what has been read";
}

/// Bricks that were read and let go since they were empty are asked for again only where an edit may show them.
TEST_F(PagedSession, AnEditReadsWhatItMayShow) {
    Session paged(Device::cpu(2)), whole(Device::cpu(2));
    paged.show(open_sample("shells", 224), {.memory_bytes = 36 * mebibyte}, progress);
    whole.show(make_sample("shells", 224), progress);
    TransferFunction tf = paged.resolve({});
    const auto show = [&](double from, double opacity) {
        tf.points = {{from, {1, 0.8, 0.5}, 0}, {from + 4, {1, 0.8, 0.5}, opacity}, {255, {1, 0.8, 0.5}, opacity}};
        scene.transfer.points = tf;
        EXPECT_EQ(picture(paged), picture(whole)) << from << " " << opacity;
        return paged.paging()->bricks_read;
    };
    const std::size_t first = show(100, 0.9);
    EXPECT_EQ(show(101, 0.9), first) << "what is empty still is";
    show(20, 0.01);
    EXPECT_GT(show(100, 0.01), first) << "nothing hides what lies behind";
}

/// Soon lit by every other voxel of the level that is there whole: about as near to its own light as a volume is that
/// is whole, whose picture is coarser.
TEST_F(PagedSession, AnEditIsLitSoon) {
    scene.illumination.method = Method::spao;
    scene.camera.zoom = 5;
    scene.width = 320, scene.height = 240;
    const auto apart = [&](Session& session) {
        const std::vector<std::uint8_t> soon = session.preview(scene, progress, DraftLight::soon).pixels,
                                        own = session.preview(scene, progress, DraftLight::own).pixels;
        double sum = 0;
        for (std::size_t i = 0; i < own.size(); ++i) sum += std::abs(own[i] - soon[i]);
        return sum / double(own.size());
    };
    Session paged(Device::cpu(2)), whole(Device::cpu(2));
    paged.show(open_sample("shells", 656), {.memory_bytes = 500 * mebibyte}, progress);
    whole.show(make_sample("shells", 328), progress);
    ASSERT_EQ(paged.volume().dimensions(), whole.volume().dimensions());
    ASSERT_TRUE(paged.is_lit_soon(scene));
    picture(paged);
    ASSERT_EQ(paged.paging()->level, 0);
    scene.transfer.opacity_scale = 0.5;
    const double by_bricks = apart(paged);
    EXPECT_GT(by_bricks, 0) << "another light";
    EXPECT_LT(by_bricks, 1.2 * apart(whole)) << "in 255ths";
}

TEST_F(PagedSession, LabelsAreSeenOnTheWholeLevel) {
    scene.volume = "sample:torso:224";
    Session session(Device::cpu(2));
    session.show(open_sample("torso", 224), {.memory_bytes = 36 * mebibyte}, progress);
    const auto unlabelled = picture(session);
    scene.labels.source = "sample:organs:64";
    EXPECT_NE(picture(session), unlabelled);
    EXPECT_NE(session.paging()->stopped_by.find("labels"), std::string::npos) << session.paging()->stopped_by;
}

/// On the way to the finest level each coarser one is shown.
TEST_F(PagedSession, ComesToItsLevelStepByStep) {
    Session paged(Device::cpu(2)), at_once(Device::cpu(2));
    const PagingSettings settings{.memory_bytes = 24 * mebibyte};
    for (Session* session : {&paged, &at_once}) session->show(open_sample("shells", 288), settings, progress);
    std::vector<std::vector<std::uint8_t>> shown;
    const auto keep = [&](const Image& image) { shown.push_back(image.pixels); };
    const std::vector<std::uint8_t> last = paged.render(scene, progress, keep).pixels;
    ASSERT_EQ(paged.paging()->light_level, 2) << "else there is no step between";
    ASSERT_EQ(paged.paging()->level, 0);
    ASSERT_EQ(shown.size(), 1u);
    EXPECT_EQ(picture(at_once), last) << "the way makes no difference";
    Session level_one(Device::cpu(2));
    level_one.show(open_sample("shells", 288), {.memory_bytes = settings.memory_bytes, .finest_level = 1}, progress);
    EXPECT_EQ(picture(level_one), shown.front());
    shown.clear();
    scene.camera.azimuth_deg = 90;
    paged.render(scene, progress, keep);
    ASSERT_EQ(shown.size(), 1u) << "what was there of its level, before the rest was read";
    EXPECT_NE(picture(paged), shown.front());
    shown.clear();
    scene.camera.azimuth_deg += 1e-6;
    paged.render(scene, progress, keep);
    EXPECT_TRUE(shown.empty()) << "nothing was missing";
}

namespace {

/// Cancels after so many bricks of the finest level.
class Cancelling : public BrickSource {
public:
    Cancelling(std::shared_ptr<const BrickSource> source, Progress& progress, int after)
        : BrickSource(header_of(*source), source->levels()), source_(source), progress_(progress), left_(after) {}
    void read(int level, const VoxelBox& box, std::byte* to) const override {
        source_->read(level, box, to);
        if (level == 0) ++reads;
        if (level == 0 && --left_ <= 0) progress_.cancel();
    }
    mutable std::atomic<int> reads{0};

private:
    static Volume header_of(const BrickSource& source) {
        Volume header;
        header.dimensions = source.header().dimensions, header.geometry = source.header().geometry;
        header.type = source.header().type, header.source = source.header().source;
        return header;
    }

    std::shared_ptr<const BrickSource> source_;
    Progress& progress_;
    mutable std::atomic<int> left_;
};

}  // namespace

TEST_F(PagedSession, WhatWasReadBeforeACancelIsNotReadAgain) {
    const PagingSettings settings{.memory_bytes = 36 * mebibyte};
    Session plain(Device::cpu(2)), cancelled(Device::cpu(2));
    plain.show(open_sample("shells", 224), settings, progress);
    const auto expected = picture(plain);
    const int all = int(plain.paging()->bricks_read);
    ASSERT_GT(all, 12);
    Progress first;
    const auto source = std::make_shared<Cancelling>(open_sample("shells", 224), first, 8);
    cancelled.show(source, settings, progress);
    EXPECT_THROW(cancelled.render(scene, first), Error);
    EXPECT_LE(source->reads, 8 + 2) << "of two threads";
    EXPECT_EQ(picture(cancelled), expected);
    EXPECT_LE(source->reads, all + 2) << "what two threads had begun";
}

TEST_F(PagedSession, StopsWhereAVoxelIsAPixelWhereThereIsNoRoomAndWhereAllIsNeeded) {
    const auto source = open_sample("shells", 224);
    Session session(Device::cpu(2));
    session.show(source, {.memory_bytes = 36 * mebibyte}, progress);
    scene.camera.zoom = 0.5;
    picture(session);
    EXPECT_EQ(session.paging()->stopped_by, "pixels");
    EXPECT_EQ(session.paging()->level, 1);
    scene.camera.zoom = 6;
    scene.mode = Mode::mip;
    picture(session);
    EXPECT_EQ(session.paging()->level, 1);
    EXPECT_NE(session.notes().back().find("there as a whole"), std::string::npos) << session.notes().back();
    scene.mode = Mode::dvr;
    session.show(source, {.memory_bytes = 36 * mebibyte, .finest_level = 1}, progress);
    picture(session);
    EXPECT_EQ(session.paging()->stopped_by, "level");
    session.show(source, {.memory_bytes = 6 * mebibyte}, progress);
    scene.camera.zoom = 1.5;
    scene.width = 300, scene.height = 250;
    picture(session);
    EXPECT_EQ(session.paging()->stopped_by, "memory");
}

namespace {

/// A raw file of floats: a ball, a speck that no coarse level has, and numbers that are none.
struct PagedFile : PagedSession {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / fmt::format("chiaro-{}_128x128x128_float32.raw", getpid());

    void SetUp() override {
        PagedSession::SetUp();
        std::vector<float> voxels(128 * 128 * 128);
        const auto at = [&](int x, int y, int z) -> float& { return voxels[std::size_t((z * 128 + y) * 128 + x)]; };
        for (int z = 0; z < 128; ++z)
            for (int y = 0; y < 128; ++y)
                for (int x = 0; x < 128; ++x)
                    at(x, y, z) = 40 - std::hypot(float(x) - 64, float(y) - 64, float(z) - 64);
        for (int i = 0; i < 3; ++i) at(10 + i % 2, 12, 110 - i / 2) = 500;
        at(64, 64, 30) = at(65, 64, 31) = std::numeric_limits<float>::quiet_NaN();
        at(0, 0, 0) = -300;
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(voxels.data()), std::streamsize(voxels.size() * sizeof(float)));
        TransferFunction tf;
        tf.points = {{0, {1, 0.8, 0.5}, 0}, {2, {1, 0.8, 0.5}, 0.4}, {60, {0.9, 0.2, 0.1}, 0.9}, {500, {0, 0, 1}, 1}};
        scene.transfer.points = tf;
        scene.camera.zoom = 1.2;
        scene.width = 240, scene.height = 200;
    }
    void TearDown() override { std::filesystem::remove(path); }
};

}  // namespace

TEST_F(PagedFile, ExactlyShowsWhatTheWholeOneDoes) {
    Session paged(Device::cpu(2)), whole(Device::cpu(2));
    PagingSettings settings{.memory_bytes = 20 * mebibyte, .exact = true};
    paged.show(open_brick_source(path, {}), settings, progress);
    whole.show(read_volume(path, {}, progress), progress);
    EXPECT_EQ(picture(paged), picture(whole));
    EXPECT_EQ(paged.paging()->level, 0);
    settings.exact = false;
    paged.show(open_brick_source(path, {}), settings, progress);
    EXPECT_NE(picture(paged), picture(whole)) << "the speck stands alone";
}

TEST_F(PagedFile, WhatIsLostIsToldAndStoodFor) {
    Session session(Device::cpu(2));
    session.show(open_brick_source(path, {}), {.memory_bytes = 20 * mebibyte}, progress);
    std::filesystem::resize_file(path, 128 * 128 * 60 * sizeof(float));
    const auto drawn = picture(session);
    const auto notes = session.notes();
    EXPECT_TRUE(std::ranges::any_of(notes, [](auto& note) { return note.find("cut short") != note.npos; }));
    EXPECT_TRUE(std::ranges::any_of(notes, [](auto& note) { return note.find("bricks cannot be read") != note.npos; }));
    EXPECT_EQ(session.paging()->level, 0) << "of what is there";
    EXPECT_GT(*std::ranges::max_element(drawn), 100);
}

namespace {
struct BricksTool : ToolTest {};
}  // namespace

TEST_F(BricksTool, RendersByBricksAndTellsTheLevel) {
    const std::string look = " --size 90x70 --lighting none --interpolation linear --fit volume";
    const Said said =
        tool("render sample:tubes:256 -o a.png --memory 40M --zoom 5 --stats s.json --first-picture f.png" + look);
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_NE(said.err.find("level 0 of 0 to 3 is drawn, 256x256x256 voxels: the finest; light of level"),
              std::string::npos)
        << said.err;
    EXPECT_EQ(json("s.json")["paging"]["level"], 0);
    EXPECT_GT(json("s.json")["paging"]["bricks"], 3);
    ASSERT_EQ(tool("render sample:tubes:256 -o b.png --memory 8G --zoom 5" + look).code, 0);
    EXPECT_EQ(tool("compare a.png b.png --fail-above max=0").code, 0);
    EXPECT_TRUE(std::filesystem::exists(folder / "f.png"));
}

TEST_F(BricksTool, FilmsByBricksAreThoseOfTheWhole) {
    const std::string look =
        R"("sampling": {"interpolation": "linear"}, "lighting": {"method": "none"}, "image": {"size": [90, 70]})";
    const auto key = [&](int azimuth) {
        return fmt::format(R"({{"at": {0}, "scene": {{"volume": {{"file": "sample:tubes:256"}}, {1},
            "camera": {{"azimuth": {0}, "fit_scale": 0.2, "fit": "volume"}}}}}})",
                           azimuth, look);
    };
    std::ofstream(folder / "film.json") << fmt::format(
        R"({{"film": 1, "fps": 0.1, "size": [90, 70], "keys": [{}, {}]}})", key(0), key(20));
    for (const std::string memory : {"40M", "8G"}) {
        const Said said = tool(fmt::format("render --film film.json -o {0}-{{frame:02}}.png --memory {0}", memory));
        ASSERT_EQ(said.code, 0) << said.err;
    }
    for (const char* frame : {"00", "02"})
        EXPECT_EQ(tool(fmt::format("compare 40M-{0}.png 8G-{0}.png --fail-above max=0", frame)).code, 0) << frame;
}

TEST_F(BricksTool, ALevelAloneIsTheSampleOfItsSize) {
    const std::string look = " --size 90x70";
    ASSERT_EQ(tool("render sample:shells:512 -o a.png --level 3 --opacity-unit 8 --spao-levels 10" + look).code, 0);
    ASSERT_EQ(tool("render sample:shells:64 -o b.png --interpolation linear" + look).code, 0);
    EXPECT_EQ(tool("compare a.png b.png --fail-above max=0").code, 0);
}

TEST_F(BricksTool, InfoMeasuresACoarseLevel) {
    ASSERT_EQ(tool("info sample:shells:4096 --memory 1G --json").code, 0);
    const auto told = nlohmann::json::parse(tool("info sample:shells:4096 --memory 1G --json").out);
    EXPECT_EQ(told["dimensions"], (std::array{4096, 4096, 4096}));
    EXPECT_EQ(told["statistics"], "sampled");
    EXPECT_EQ(told["levels"].size(), 8u);
    EXPECT_EQ(nlohmann::json::parse(tool("info sample:shells:64 --json").out)["statistics"], "exact");
    EXPECT_EQ(nlohmann::json::parse(tool("info sample:shells:128 --memory 16M --exact --json").out)["statistics"],
              "exact");
}

TEST_F(BricksTool, RefusesWhatItCannotReadByBricks) {
    ASSERT_EQ(tool("sample ball -o whole.nrrd --size 16").code, 0);
    ASSERT_EQ(tool("convert whole.nrrd ball.nrrd --encoding gzip").code, 0);
    std::filesystem::remove(folder / "whole.nrrd");
    Said said = tool("render ball.nrrd -o a.png --level 1");
    EXPECT_EQ(said.code, 2);
    EXPECT_NE(said.err.find("is read as a whole"), std::string::npos) << said.err;
    said = tool("render sample:ball:64 -o a.png --level 5");
    EXPECT_EQ(said.code, 2);
    EXPECT_NE(said.err.find("has levels 0 to 1"), std::string::npos) << said.err;
    EXPECT_EQ(tool("render sample:ball:64 -o a.png --memory 3X").code, 2);
    EXPECT_EQ(tool("render sample:ball:64 -o a.png --memory 1K").code, 2);
    EXPECT_EQ(files(), "ball.nrrd");
}

// The tool on a volume that changes with time: a series of pictures is what its moments are alone.
#include <fmt/format.h>

#include <cmath>

#include "tool_case.h"
#include "volume_files.h"

namespace {

/// A ball that grows and becomes brighter from moment to moment, with a little one beside it.
class MomentsTool : public ToolTest {
protected:
    static constexpr int count = 4, size = 20;

    void SetUp() override {
        ToolTest::SetUp();
        if (!IsSkipped()) write("beat.nrrd", header() + voxels());
    }

    static std::string header() {
        return fmt::format(
            "NRRD0005\ntype: uint8\ndimension: 4\nencoding: raw\nsizes: {0} {0} {0} {1}\n"
            "kinds: domain domain domain time\nspacings: 1 1 1 40\n\n",
            size, count);
    }
    static std::string voxels() {
        std::string all;
        for (int t = 0; t < count; ++t)
            for (int z = 0; z < size; ++z)
                for (int y = 0; y < size; ++y)
                    for (int x = 0; x < size; ++x) {
                        const double r = std::hypot(x - 9.5, y - 9.5, z - 9.5), edge = 4 + t - r;
                        all += char(std::lround((90 + 30 * t) * std::clamp(edge, 0.0, 1.0)));
                    }
        return all;
    }
};

}  // namespace

TEST_F(MomentsTool, DrawsEveryMomentAsItIsAlone) {
    const std::string look = " --size 64x48 --transfer inferno ";
    for (const std::string light : {"--lighting transport --probe sky", "--interpolation auto --lighting spao"}) {
        const Said all = tool("render beat.nrrd -o all-{t:02}.png --stats all.json" + look + light);
        ASSERT_EQ(all.code, 0) << all.err;
        EXPECT_NE(all.err.find("holds 4 moments in time; the first is shown"), std::string::npos) << all.err;
        for (int t = 0; t < count; ++t) {
            const std::string one = fmt::format("render beat.nrrd -o all-{:02}.png --time {}", t + 10, t);
            const Said said = tool(one + " --stats one.json" + look + light);
            ASSERT_EQ(said.code, 0) << said.err;
            EXPECT_EQ(said.err.find("moment 3 of 4: its range, look and camera are those of moment 0") != said.err.npos,
                      t == 3)
                << said.err;
            EXPECT_EQ(read(fmt::format("all-{:02}.png", t)), read(fmt::format("all-{:02}.png", t + 10))) << t << light;
            EXPECT_EQ(json("one.json")["frames"][0]["moment"], t);
            EXPECT_EQ(json("one.json")["volume"]["moments"]["shown"], t);
            EXPECT_EQ(json("all.json")["frames"][std::size_t(t)]["moment"], t);
        }
        EXPECT_NE(read("all-00.png"), read("all-03.png"));
        // A picture remakes itself: its scene names the moment.
        ASSERT_EQ(tool("render --scene all-02.png -o again.png").code, 0);
        EXPECT_EQ(tool("compare all-02.png again.png --fail-above max=0").code, 0);
    }
}

TEST_F(MomentsTool, RangeIsTheFirstMoments) {
    ASSERT_EQ(tool("convert beat.nrrd last.nrrd --time 3").code, 0);
    const std::string look = " --size 64x48 --fit volume --lighting none --transfer gray";
    ASSERT_EQ(tool("render beat.nrrd -o a.png --time 3" + look).code, 0);
    ASSERT_EQ(tool("render last.nrrd -o own.png" + look).code, 0);
    EXPECT_EQ(tool("compare a.png own.png --fail-above max=0").code, 5);  // its own range would be another
    // With one range stated for both they are one picture.
    const std::string window = " --window 45,90";
    ASSERT_EQ(tool("render beat.nrrd -o b.png --time 3" + window + look).code, 0);
    ASSERT_EQ(tool("render last.nrrd -o c.png" + window + look).code, 0);
    EXPECT_EQ(tool("compare b.png c.png --fail-above max=0").code, 0);
}

TEST_F(MomentsTool, InfoListsThem) {
    const Said text = tool("info beat.nrrd");
    EXPECT_NE(text.out.find("moments     4, of which this is 0\n              0: 0   1: 40   2: 80   3: 120\n"),
              std::string::npos)
        << text.out;
    const auto told = nlohmann::json::parse(tool("info beat.nrrd --json --time 2").out);
    EXPECT_EQ(told["moments"]["count"], 4);
    EXPECT_EQ(told["moments"]["shown"], 2);
    EXPECT_EQ(told["moments"]["times"], nlohmann::json({0, 40, 80, 120}));
    EXPECT_EQ(told["range"][1], 150);
    EXPECT_FALSE(nlohmann::json::parse(tool("info sample:ball:8 --json").out).contains("moments"));
}

TEST_F(MomentsTool, FilmsGoThroughMoments) {
    const std::string key = R"({{"at": {}, "scene": {{"chiaro": 1, "volume": {{"file": "beat.nrrd", "time": {}}}}}}})";
    write("film.json", R"({"film": 1, "fps": 3, "size": [32, 24], "keys": [)" + fmt::format(fmt::runtime(key), 0, 0) +
                           ", " + fmt::format(fmt::runtime(key), 1, 3) + "]}");
    const Said said = tool("render --film film.json -o film-{frame}.png");
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_EQ(files(), "beat.nrrd film-0.png film-1.png film-2.png film-3.png film.json");
    ASSERT_EQ(tool("render --scene film-2.png -o again.png").code, 0);
    EXPECT_EQ(tool("compare film-2.png again.png --fail-above max=0").code, 0);
    EXPECT_EQ(tool("compare film-1.png again.png --fail-above max=0").code, 5);
}

TEST_F(MomentsTool, RefusesInOneSentence) {
    const auto expect = [&](const std::string& arguments, int code, const std::string& part) {
        const Said said = tool(arguments);
        EXPECT_EQ(said.code, code) << said.err;
        EXPECT_NE(said.err.find(part), std::string::npos) << said.err;
    };
    expect("render beat.nrrd -o a.png --time 4", 3, "holds 4 moments in time, 0 to 3: there is none of number 4");
    expect("render beat.nrrd -o a-{t}.png --time 1", 2, "a {t} draws every moment");
    expect("render beat.nrrd -o a-{t}.png --frames 3", 2, "a {t} draws every moment");
    expect("render beat.nrrd -o a-{u}.png", 2, "the only placeholders are {frame} and {t}");
    expect("render beat.nrrd -o a.png --time -1", 2, "time");
    // Moments of other sizes are no moments.
    write("m0.nrrd",
          "NRRD0004\ntype: uint8\ndimension: 3\nencoding: raw\nsizes: 2 2 2\n\n" + std::string("\0\1\2\3\4\5\6\7", 8));
    write("m1.nrrd",
          "NRRD0004\ntype: uint8\ndimension: 3\nencoding: raw\nsizes: 2 2 1\n\n" + std::string("\0\1\2\3", 4));
    expect("render m{t}.nrrd -o a-{t}.png --size 8x8", 3, "moment 1 has 2x2x1 voxels, where the first one has 2x2x2");
}

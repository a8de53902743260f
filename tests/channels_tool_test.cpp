// The tool on several channels: components of a file, files, scenes, and what is refused.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tool_case.h"

namespace {

/// Two balls: as files, and as the components of one.
class ChannelsTool : public ToolTest {
protected:
    static constexpr int size = 20;
    static constexpr const char* look = " --size 64x48 --lighting spao ";

    void SetUp() override {
        ToolTest::SetUp();
        if (IsSkipped()) return;
        std::string a, b, both;
        for (int z = 0; z < size; ++z)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    a += ball(x, y, z, 7), b += ball(x, y, z, 12);
                    both += a.back(), both += b.back();
                }
        const std::string grid = fmt::format("sizes: {0} {0} {0}\nspacings: 1 1 1\n\n", size);
        const std::string head = "NRRD0005\ntype: uint8\nencoding: raw\n";
        write("a.nrrd", head + "dimension: 3\n" + grid + a);
        write("b.nrrd", head + "dimension: 3\n" + grid + b);
        write("both.nrrd", head +
                               fmt::format("dimension: 4\nsizes: 2 {0} {0} {0}\nspacings: nan 1 1 1\n"
                                           "kinds: list domain domain domain\n\n",
                                           size) +
                               both);
        // The same as b, every second voxel of it.
        std::string coarse;
        for (int z = 0; z < size; z += 2)
            for (int y = 0; y < size; y += 2)
                for (int x = 0; x < size; x += 2) coarse += ball(x, y, z, 12);
        write("coarse.nrrd",
              head + fmt::format("dimension: 3\nsizes: {0} {0} {0}\nspacings: 2 2 2\n\n", size / 2) + coarse);
    }

    static char ball(int x, int y, int z, int at_x) {
        const double r = std::hypot(x - at_x, y - 9.5, z - 9.5);
        return char(std::lround(200 * std::clamp(6 - r, 0.0, 1.0)));
    }
};

}  // namespace

TEST_F(ChannelsTool, ComponentsAndFilesAreTheSameChannels) {
    const Said components = tool(std::string("render both.nrrd -o one.exr") + look);
    ASSERT_EQ(components.code, 0) << components.err;
    EXPECT_NE(components.err.find("2 channels are shown together"), std::string::npos) << components.err;
    ASSERT_EQ(tool(std::string("render a.nrrd --channel b.nrrd -o two.png --quiet") + look).code, 0);
    ASSERT_EQ(tool(std::string("render both.nrrd -o one.png --quiet") + look).code, 0);
    EXPECT_EQ(tool("compare one.png two.png --fail-above max=0").code, 0);
    ASSERT_EQ(tool(std::string("render a.nrrd -o alone.png --quiet") + look).code, 0);
    EXPECT_EQ(tool("compare one.png alone.png --fail-above max=0.05").code, 5);
}

TEST_F(ChannelsTool, APictureCarriesThem) {
    ASSERT_EQ(tool(std::string("render a.nrrd --channel b.nrrd --channel-gains 1,0.5 --channel-transfers -,viridis "
                               "-o one.png --quiet") +
                   look)
                  .code,
              0);
    const Said again = tool("render --scene one.png -o again.png --quiet");
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(tool("compare one.png again.png --fail-above max=0").code, 0);
    ASSERT_EQ(tool("render --scene one.png --channel-gains 1,0 -o hidden.png --quiet").code, 0);
    EXPECT_EQ(tool("compare one.png hidden.png --fail-above max=0.02").code, 5);
    write("scene.json",
          R"({"chiaro": 1, "volume": {"file": "both.nrrd"}, "channels": [{"gain": 0}, {"name": "b", "hue": 1}]})");
    const Said told = tool("render --scene scene.json -o s.png");
    EXPECT_EQ(told.code, 0) << told.err;
    EXPECT_NE(told.err.find("unknown key channels[1].hue"), std::string::npos) << told.err;
}

TEST_F(ChannelsTool, AnotherGridIsResampledOnceAndTold) {
    const Said said = tool(std::string("render a.nrrd --channel coarse.nrrd -o one.png") + look);
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_NE(said.err.find("coarse.nrrd: resampled from 10x10x10 voxels onto the volume's 20x20x20"),
              std::string::npos)
        << said.err;
    ASSERT_EQ(tool(std::string("render a.nrrd --channel b.nrrd -o two.png --quiet") + look).code, 0);
    // Half as fine, but in its place: much nearer than without it.
    ASSERT_EQ(tool(std::string("render a.nrrd -o alone.png --quiet") + look).code, 0);
    const auto rmse = [&](const std::string& name) {
        return nlohmann::json::parse(tool("compare two.png " + name + " --json").out)["rmse"].get<double>();
    };
    EXPECT_LT(rmse("one.png"), 0.3 * rmse("alone.png"));
}

TEST_F(ChannelsTool, RefusesInOneSentence) {
    const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
        const Said said = tool("render a.nrrd -o no.png --quiet " + arguments);
        EXPECT_EQ(said.code, code) << arguments << said.err;
        EXPECT_NE(said.err.find(part), std::string::npos) << said.err;
        EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "no.png"));
    };
    refused("--channel b.nrrd --classification preintegrated", 2, "several go with post and pre");
    refused("--channel b.nrrd --lighting histogram --cache none", 2, "--hist-channel N chooses one");
    refused("--channel b.nrrd --lighting histogram --cache none --hist-channel 3", 2, "the volume has 2 channels");
    refused("--channels-as rgb", 3, "it has 1 value a voxel");
    refused("--channel b.nrrd --mode iso --iso 50", 2, "of one channel");
    refused("--channel b.nrrd --channel-gains 1", 2, "too few");
    refused("--channel b.nrrd --channel-gains 1,-1", 2, "must be 0");
    refused("--channel none.nrrd", 3, "none.nrrd");
    refused("--channel both.nrrd", 3, "where a channel has one");
    std::string nine;
    for (int i = 0; i < 8; ++i) nine += "--channel b.nrrd ";
    refused(nine, 3, "at most 8 channels");
}

// A file of three bytes a voxel is in its own colours, unless it or the user says otherwise.
TEST_F(ChannelsTool, ThreeBytesAreColors) {
    std::string colors;
    for (int z = 0; z < size; ++z)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) colors += {ball(x, y, z, 7), ball(x, y, z, 12), ball(x, y, z, 12)};
    const auto write_as = [&](const std::string& name, const std::string& kind) {
        write(name, fmt::format("NRRD0005\ntype: uint8\nencoding: raw\ndimension: 4\nsizes: 3 {0} {0} {0}\n"
                                "spacings: nan 1 1 1\nkinds: {1} domain domain domain\n\n",
                                size, kind) +
                        colors);
    };
    write_as("rgb.nrrd", "RGB-color"), write_as("list.nrrd", "list");
    const Said own = tool(std::string("render rgb.nrrd -o own.png") + look);
    ASSERT_EQ(own.code, 0) << own.err;
    EXPECT_NE(own.err.find("in its own colours, its opacity by luminance"), std::string::npos) << own.err;
    const Said three = tool(std::string("render list.nrrd -o three.png") + look);
    EXPECT_NE(three.err.find("3 channels are shown together"), std::string::npos) << three.err;
    ASSERT_EQ(tool(std::string("render rgb.nrrd --channels-as channels -o same.png --quiet") + look).code, 0);
    EXPECT_EQ(tool("compare three.png same.png --fail-above max=0").code, 0);
    ASSERT_EQ(tool(std::string("render list.nrrd --channels-as rgb -o rgb.png --quiet") + look).code, 0);
    EXPECT_EQ(tool("compare own.png rgb.png --fail-above max=0").code, 0);
    EXPECT_EQ(tool("compare own.png three.png --fail-above max=0.05").code, 5);
    ASSERT_EQ(tool("render --scene rgb.png -o again.png --quiet").code, 0);
    EXPECT_EQ(tool("compare own.png again.png --fail-above max=0").code, 0);
    const Said gains = tool("render rgb.nrrd --channel-gains 1,1,1 -o no.png");
    EXPECT_EQ(gains.code, 2) << gains.err;
    EXPECT_NE(gains.err.find("--channels-as channels"), std::string::npos) << gains.err;
    // What is written keeps what it is, and tells its values.
    ASSERT_EQ(tool("convert rgb.nrrd copy.nrrd --quiet").code, 0);
    ASSERT_EQ(tool(std::string("render copy.nrrd -o copy.png --quiet") + look).code, 0);
    EXPECT_EQ(tool("compare own.png copy.png --fail-above max=0").code, 0);
    const auto info = nlohmann::json::parse(tool("info list.nrrd --json").out);
    ASSERT_EQ(info["channels"].size(), 3u);
    EXPECT_EQ(info["channels"][2]["range"], nlohmann::json({0, 200}));
    EXPECT_TRUE(nlohmann::json::parse(tool("info rgb.nrrd --json").out)["own_colors"].get<bool>());
}

// Moments of a file of two channels: each is the picture of a file that holds it alone, by the first one's range.
TEST_F(ChannelsTool, ChangeWithTime) {
    std::string all, second;
    for (int t = 0; t < 2; ++t)
        for (int z = 0; z < size; ++z)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    all += {ball(x, y, z, 7 + t), ball(x, y, z, 12 - 2 * t)};
                    if (t == 1) second += {ball(x, y, z, 8), ball(x, y, z, 10)};
                }
    const std::string head = "NRRD0005\ntype: uint8\nencoding: raw\n";
    write("beat.nrrd", head +
                           fmt::format("dimension: 5\nsizes: 2 {0} {0} {0} 2\nspacings: nan 1 1 1 nan\n"
                                       "kinds: list domain domain domain time\n\n",
                                       size) +
                           all);
    write("second.nrrd", head +
                             fmt::format("dimension: 4\nsizes: 2 {0} {0} {0}\nspacings: nan 1 1 1\n"
                                         "kinds: list domain domain domain\n\n",
                                         size) +
                             second);
    const std::string still = std::string(look) + "--fit volume --quiet ";
    ASSERT_EQ(tool("render beat.nrrd -o t{t:01}.png" + still).code, 0);
    ASSERT_EQ(tool("render beat.nrrd --time 1 -o one.png" + still).code, 0);
    EXPECT_EQ(tool("compare t1.png one.png --fail-above max=0").code, 0);
    ASSERT_EQ(tool("render second.nrrd -o second.png" + still).code, 0);
    EXPECT_EQ(tool("compare t1.png second.png --fail-above max=0").code, 0);  // whose values have the same range
    EXPECT_EQ(tool("compare t0.png t1.png --fail-above max=0.02").code, 5);
    const Said files = tool("render beat.nrrd --channels-as channels --channel a.nrrd --time 1 -o no.png --quiet");
    EXPECT_EQ(files.code, 2);
    EXPECT_NE(files.err.find("channels of several files"), std::string::npos) << files.err;
}

// The tool as a script sees it: exit codes, messages, files.
#include "changed_scene.h"
#include "tool_case.h"

namespace {

using Tool = ToolTest;

TEST_F(Tool, RefusesInOneLine) {
    write("bad.nrrd", "NRRD0004\ntype: uint8\nrubbish\n");
    write("bad.json", "{");
    write("two.json", R"({"chiaro": 2, "volume": {"file": "sample:ball"}})");
    std::filesystem::create_directory(folder / "folder.png");
    std::filesystem::create_directory(folder / "empty");
    write("nan.nrrd", "NRRD0004\ntype: float\ndimension: 3\nsizes: 1 1 1\nencoding: ascii\n\nnan\n");
    write("up.json", R"({"chiaro": 1, "volume": {"file": "sample:ball"}, "camera": {"up": [0, 0, 0]}})");
    struct Case {
        const char* arguments;
        int code;
        const char* message;
    };
    const Case cases[] = {
        {"", 2, "no command given"},
        {"rendr x", 2, "unknown command 'rendr'; did you mean 'render'?"},
        {"--list-preset", 2, "did you mean '--list-presets'?"},
        {"info", 2, "VOLUME is missing"},
        {"info none.nrrd", 3, "none.nrrd"},
        {"info bad.nrrd", 3, "bad.nrrd"},
        {"info sample:bal", 2, "did you mean 'ball'?"},
        {"info empty", 3, "the folder is empty"},
        {"info .", 3, "holds no DICOM image, but"},
        {"info nan.nrrd", 3, "no voxel of nan.nrrd is a finite number"},
        {"info sample:ball --rescale 0,1", 2, "slope of 0"},
        {"info sample:ball extra", 2, "unknown argument 'extra'"},
        {"sample", 2, "NAME is missing"},
        {"sample ball", 2, "-o FILE is missing"},
        {"sample ball -o ball.png", 2, "ball.png: the name must end in .nrrd"},
        {"sample ball --size 1 -o b.nrrd", 2, "2..4096"},
        {"render -o a.png", 2, "give either a VOLUME or --scene FILE"},
        {"render sample:ball --scene two.json -o a.png", 2, "give either a VOLUME or --scene FILE"},
        {"render sample:ball", 2, "-o FILE is missing"},
        {"render sample:ball -o a.jpg", 2, "a.jpg: the name must end in .png or .exr"},
        {"render sample:ball -o a.exr --color display", 2, "a.exr: --color display gives no linear light"},
        {"render sample:ball -o no/a.png", 4, "there is no folder no"},
        {"render sample:ball -o folder.png", 4, "is a folder"},
        {"render sample:ball -o a.png --stats no/s.json", 4, "there is no folder no"},
        {"render sample:ball -o a.png --azimut 5", 2, "unknown option '--azimut'; did you mean '--azimuth'?"},
        {"render sample:ball -o a.png --azimut=5", 2, "unknown option '--azimut'; did you mean '--azimuth'?"},
        {"render sample:ball -o a.png --spao-levels 0", 2, "--spao-levels 0: must be 1 to 14"},
        {"render sample:ball -o a.png --lighting spoa", 2, "did you mean 'spao'?"},
        {"render sample:ball -o a.png --step 0", 2, "--step 0: must be 0.001 to 100 voxels"},
        {"render sample:ball -o a.png --step", 2, "--step"},
        {"render sample:ball -o a.png --background blu", 2, "did you mean 'blue'?"},
        {"render sample:ball -o a.png --transfer virids", 2, "did you mean 'viridis'?"},
        {"render sample:ball -o a.png --transfer none.json", 3, "none.json"},
        {"render sample:ball -o a.png --opacity-unit 1 --opacity-unit-mm 1", 2, "not both"},
        {"render sample:ball -o a.png --eye 1,2,3", 2, "eye and target need each other"},
        {"render nan.nrrd -o a.png --up 0,0,0", 2, "--up must point somewhere"},
        {"render nan.nrrd -o a.png --eye 1,1,1 --target 1,1,1", 2, "or nowhere"},
        {"render --scene up.json -o a.png", 3, "--up must point somewhere"},
        {"render sample:ball -o a.png --view anterior", 3, "no anatomical frame"},
        {"render sample:ball -o a.png --view anterior --frames 3", 2, "--frames turns the orbit"},
        {"render sample:ball -o a.png --frames 0", 2, "--frames 0: must be 1 to 100000"},
        {"render sample:ball -o a.png --frames -1", 2, "--frames -1"},
        {"render sample:ball -o a{frame:3}.png --frames 2", 2, "{frame:03}"},
        {"render sample:ball -o a{frame}{frame}.png --frames 2", 2, "{frame:03}"},
        {"render sample:ball -o a{frame}.png", 2, "needs --frames"},
        {"render sample:ball -o a.png --device gpu", 2, "--device gpu: must be auto, cpu or cuda[:N]"},
        {"render sample:ball -o a.png --device cuda:99", 4, "--device cuda"},
        {"render sample:ball -o a.png --device cuda:one", 2, "--device cuda:one: must be"},
        {"render sample:ball -o a.png --isa x86-64-v5", 2, "--isa x86-64-v5"},
        {"render sample:ball -o a.png --threads 5000", 2, "1024"},
        {"render sample:ball -o a.png --threads two", 2, "two"},
        {"render sample:ball -o a.png --progress maybe", 2, "--progress maybe"},
        {"render --scene bad.json -o a.png", 3, "bad.json: not JSON"},
        {"render --scene two.json -o a.png", 3, "two.json: chiaro 2"},
        {"render --scene none.json -o a.png", 3, "cannot read 'none.json': No such file or directory"},
        {"convert", 2, "IN is missing"},
        {"convert sample:ball b.mha", 2, "must end in .nrrd or .zarr or .json"},
        {"convert sample:ball b.nrrd --encoding zip", 2, "--encoding zip: must be raw, gzip"},
    };
    const std::string before = files();
    for (const auto& [arguments, code, message] : cases) {
        const Said said = tool(arguments);
        EXPECT_EQ(said.code, code) << arguments << "\n" << said.err;
        EXPECT_TRUE(said.err.starts_with("chiaro: ")) << arguments << "\n" << said.err;
        EXPECT_NE(said.err.find(message), said.err.npos) << arguments << "\n" << said.err;
        EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << arguments << "\n" << said.err;
        EXPECT_EQ(said.out, "") << arguments;
        EXPECT_EQ(files(), before) << arguments;
    }
}

TEST_F(Tool, Tells) {
    struct Case {
        const char *arguments, *text;
    };
    const Case cases[] = {
        {"--help", "render"},       {"--version", "chiaro 0.2.0"}, {"render --help", "--early-termination"},
        {"--list-methods", "none"}, {"--list-formats", "NRRD"},    {"--list-presets", "ct-bone"},
        {"--list-devices", "cpu"},  {"sample --list", "cornell"},  {"info sample:ball:16", "16x16x16 uint8"},
        {"convert --help", "gzip"},
    };
    for (const auto& [arguments, text] : cases) {
        const Said said = tool(arguments);
        EXPECT_EQ(said.code, 0) << arguments << said.err;
        EXPECT_NE(said.out.find(text), said.out.npos) << arguments << "\n" << said.out;
        EXPECT_EQ(said.err, "") << arguments;
    }
}

TEST_F(Tool, MoreThreadsThanCpusAreFine) {
    const Said said = tool("render sample:ball -o a.png --size 64x64 --threads 37");
    EXPECT_EQ(said.code, 0);
    EXPECT_EQ(said.err, "");
}

TEST_F(Tool, InfoGivesJson) {
    const auto info = nlohmann::json::parse(tool("info sample:ball:16 --json").out);
    for (const char* key :
         {"file", "format", "dimensions", "type", "components", "spacing_mm", "origin_mm", "direction", "world",
          "range", "percentiles", "noise", "histogram", "nonfinite", "modality_guess", "preset_guess", "notes"})
        EXPECT_TRUE(info.contains(key)) << key;
    EXPECT_EQ(info["dimensions"], nlohmann::json({16, 16, 16}));
    EXPECT_EQ(info["histogram"]["counts"].size(), 256u);
    EXPECT_TRUE(info["percentiles"].contains("99.9"));
}

TEST_F(Tool, ConvertsThereAndBack) {
    EXPECT_EQ(tool("sample ball --size 16 -o a.nrrd").code, 0);
    EXPECT_EQ(tool("convert a.nrrd b.nrrd --encoding gzip").code, 0);
    EXPECT_EQ(tool("convert b.nrrd c.nrrd --encoding raw").code, 0);
    EXPECT_LT(read("b.nrrd").size(), read("a.nrrd").size());
    EXPECT_EQ(read("a.nrrd").substr(read("a.nrrd").size() - 4096), read("c.nrrd").substr(read("c.nrrd").size() - 4096));
    EXPECT_EQ(tool("convert ct-bone tf.json").code, 0);
    EXPECT_TRUE(json("tf.json").contains("points"));
    EXPECT_EQ(tool("render a.nrrd --transfer tf.json --size 16x16 -o p.png").code, 0);
}

TEST_F(Tool, TellsTheGuessOnce) {
    tool("sample ball --size 16 -o a.nrrd");
    const Said said = tool("render a.nrrd --size 16x16 -o p.png");
    EXPECT_TRUE(said.err.starts_with("chiaro: looks like ")) << said.err;
    EXPECT_NE(said.err.find("using --transfer "), said.err.npos);
    EXPECT_EQ(tool("render a.nrrd --size 16x16 -o p.png --quiet").err, "");
    EXPECT_EQ(tool("render a.nrrd --size 16x16 -o p.png --transfer gray").err, "");
    EXPECT_EQ(tool("render a.nrrd --size 16x16 --elevation -20 --up -x --light -30,20,red -o p.png --quiet").err, "");
}

/// One line for each flag that no light, camera or mode of the picture goes by; none for those that it does.
TEST_F(Tool, TellsWhatChangesNothing) {
    struct Case {
        const char *arguments, *flag;  ///< null: each changes something
    };
    const Case cases[] = {
        {"--probe sky", "--probe"},
        {"--probe sky --probe-background", nullptr},
        {"--lighting visibility --probe sky --probe-rotation 30", nullptr},
        {"--lighting visibility --light 10,20", "--light"},
        {"--lighting visibility --light 10,20 --probe lights", nullptr},
        {"--light 10,20", nullptr},
        {"--iso 40", "--iso"},
        {"--mode iso --iso 40", nullptr},
        {"--focus 100", "--focus"},
        {"--view left --azimuth 20", "--azimuth"},
        {"--eye 50,50,50 --target 0,0,0 --zoom 2", "--zoom"},
        {"--azimuth 20 --elevation 5 --zoom 2", nullptr},
        {"--eye 50,50,50 --target 0,0,0 --zoom 2 --projection orthographic", nullptr},
        {"--lighting reference --reference-quantity ao --reference-rays 4 --light 10,20", nullptr},
        {"--lighting transport --light 10,20", "--light"},
        {"--mode mip --spao-levels 3", "--spao-levels"},
        {"--mode mip --lighting none", nullptr},
        {"--lighting visibility --spao-levels 3", "--spao-levels"},
        {"--lighting visibility --sh-bands 2", nullptr},
    };
    for (const auto& [arguments, flag] : cases) {
        const Said said = tool("render sample:torso:16 --size 16x16 -o p.png " + std::string(arguments));
        EXPECT_EQ(said.code, 0) << said.err;
        if (flag)
            EXPECT_TRUE(said.err.starts_with(std::string("chiaro: ") + flag + " changes nothing: ")) << said.err;
        else
            EXPECT_EQ(said.err, "") << arguments;
        EXPECT_LE(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
    }
}

TEST_F(Tool, TellsWhereNothingIsVisible) {
    const std::string render = "render sample:ball:16 --size 16x16 -o p.png ";
    EXPECT_EQ(tool(render).err, "");
    for (const char* arguments : {"--opacity-scale 0", "--clip-plane 1,0,0,-1000", "--mode iso --iso 300"}) {
        const Said said = tool(render + arguments);
        EXPECT_EQ(said.code, 0) << arguments;
        EXPECT_TRUE(said.err.starts_with("chiaro: nothing is visible")) << arguments << said.err;
        EXPECT_EQ(tool(render + arguments + " --quiet").err, "");
    }
}

// Scene, picture, scene: what the picture carries remakes it to the byte, and is the same scene again.
TEST_F(Tool, APictureRemakesItself) {
    const std::string scene = "render sample:menger:16 --size 40x30 --quiet --transfer viridis -o a.png ";
    for (const char* flags :
         {"", "--classification preintegrated --compositing back-to-front --samples-per-pixel 3 --ray-setup raster",
          "--mode iso --iso 100,tomato@0.5 --iso 200 --clip-plane 1,0.5,0,9", "--mode mip --projection orthographic",
          "--classification pre --background transparent --azimuth 12.3 --tone aces --color display"}) {
        EXPECT_EQ(tool(scene + flags).code, 0) << flags;
        const Said said = tool("render --scene a.png -o b.png --quiet");
        EXPECT_EQ(said.code, 0) << said.err;
        EXPECT_EQ(read("a.png"), read("b.png")) << flags;
        EXPECT_EQ(tool("render --scene b.png -o c.png --quiet").code, 0);
        EXPECT_EQ(read("a.png"), read("c.png")) << flags;
    }
}

TEST_F(Tool, FlagsWinOverTheScene) {
    write(
        "s.json",
        R"({"volume": {"file": "sample:ball:16"}, "image": {"size": [20, 10]}, "camera": {"azimuth_deg": 10, "eye": [1, 2, 3], "target": [8, 8, 8]},
        "sampling": {"step": 1}, "transfer_function": {"preset": "gray", "opacity_unit_mm": 2}, "colour": "display"})");
    const Said said =
        tool("render --scene s.json --size 30x10 --azimuth 50 --transfer viridis -o p.png --stats t.json");
    EXPECT_EQ(said.code, 0);
    EXPECT_EQ(said.err, "chiaro: s.json: unknown key colour; did you mean 'color'?\n");
    const auto settings = json("t.json")["settings"];
    EXPECT_EQ(settings["image"]["size"], nlohmann::json({30, 10}));
    EXPECT_EQ(settings["camera"]["azimuth_deg"], 50);
    EXPECT_FALSE(settings["camera"].contains("eye"));
    EXPECT_EQ(settings["sampling"]["step"], 1);
    EXPECT_EQ(settings["transfer_function"]["preset"], "viridis");
    EXPECT_FALSE(settings["transfer_function"].contains("opacity_unit_mm"));
}

TEST_F(Tool, FlagsWinOverWhatSuitsASample) {
    write("s.json", R"({"volume": {"file": "sample:cornell:16"}})");
    const auto classification = [&](const std::string& what) {
        EXPECT_EQ(tool("render --size 16x12 --quiet -o p.png --stats t.json " + what).code, 0) << what;
        return json("t.json")["settings"]["sampling"]["classification"];
    };
    EXPECT_EQ(classification("sample:cornell:16"), "pre");
    EXPECT_EQ(classification("sample:cornell:16 --classification post"), "post");
    EXPECT_EQ(classification("--scene s.json"), "post");  // what it meant when it was written
    EXPECT_EQ(classification("sample:ball:16"), "post");
}

TEST_F(Tool, EverySettingHasAFlagThatWorks) {
    using namespace chiaro;
    Scene scene = changed_scene();
    scene.volume = "sample:ball:16";
    scene.read = {}, scene.stated = {};                                   // a raw file's layout is no sample's
    scene.camera.view.reset(), scene.camera.matrix.reset();               // excludes the eye
    scene.camera.fit_centre.reset(), scene.camera.fit_radius_mm.reset();  // are found, not given
    scene.slices = {};                                                    // of scene files alone
    scene.labels = {};                                                    // go with no isosurfaces
    std::string flags;
    const auto add = [&](const Setting& setting, const auto&... fields) {
        const std::string text = value_text(setting, fields...), name(setting.name);
        if (name.empty() || text.empty() || setting.key.starts_with("volume.")) return;
        flags += " --" + name + (text == "true" ? "" : " '" + text + "'");
    };
    for_each_setting(add, scene);
    const Said said = tool("render sample:ball:16 -o p.png --stats s.json" + flags);
    ASSERT_EQ(said.code, 0) << said.err << flags;
    std::vector<std::string> unknown;
    const Scene again = parse_scene(json("s.json")["settings"].dump(), "", "", unknown);
    EXPECT_EQ(texts_of(again), texts_of(scene));
    EXPECT_EQ(again.transfer, scene.transfer);
}

TEST_F(Tool, WritesStats) {
    EXPECT_EQ(
        tool("render sample:ball:16 --size 16x16 -o p.png --lighting none --stats s.json --threads 1 --isa scalar")
            .code,
        0);
    const auto stats = json("s.json");
    for (const char* key : {"chiaro", "device", "isa", "threads", "volume", "settings", "stages", "frames", "samples",
                            "peak_memory_bytes"})
        EXPECT_TRUE(stats.contains(key)) << key;
    EXPECT_EQ(stats["isa"], "scalar");
    EXPECT_EQ(stats["threads"], 1);
    EXPECT_EQ(stats["frames"].size(), 1u);
    EXPECT_GT(stats["samples"], 0);
    std::string names;
    for (const auto& stage : stats["stages"]) names += stage["name"].get<std::string>() + " ";
    EXPECT_EQ(names, "read measure upload prepare classify interpolate fit illuminate raycast develop write ");
}

TEST_F(Tool, RendersTurntables) {
    EXPECT_EQ(tool("render sample:menger:16 --size 16x16 --frames 3 -o t-{frame:03}.png --stats s.json").code, 0);
    EXPECT_EQ(files(), "s.json t-000.png t-001.png t-002.png");
    EXPECT_EQ(json("s.json")["frames"].size(), 3u);
    EXPECT_NE(read("t-000.png"), read("t-001.png"));
    EXPECT_EQ(tool("render sample:menger:16 --size 16x16 --frames 2 -o one.png").code, 0);
    EXPECT_EQ(read("one.png"), read("t-000.png"));
    // Of one picture the camera fits what that shows, of a turntable what all frames do.
    EXPECT_EQ(tool("render --scene t-000.png -o still.png").code, 0);
    EXPECT_EQ(read("still.png"), read("t-000.png"));
    EXPECT_EQ(tool("render sample:menger:16 --size 16x16 --fit volume --frames 2 -o one.png").code, 0);
    EXPECT_EQ(tool("render sample:menger:16 --size 16x16 --fit volume -o still.png").code, 0);
    EXPECT_EQ(read("still.png"), read("one.png"));
}

TEST_F(Tool, AnInterruptLeavesNothingHalfWritten) {
    using namespace std::chrono_literals;
    const std::string endless =
        "render sample:ball:64 --size 2048x2048 --step 0.001 --early-termination 0 --no-skip-empty -o p.png --stats "
        "s.json";
    for (int signal : {SIGINT, SIGTERM}) {
        const Said said = tool(endless, signal, 500ms);
        EXPECT_EQ(said.code, 130);
        EXPECT_EQ(said.err, "chiaro: interrupted\n");
        EXPECT_EQ(files(), "");
    }
    write("p.png", "the picture before");
    EXPECT_EQ(tool(endless, SIGINT, 500ms).code, 130);
    EXPECT_EQ(read("p.png"), "the picture before");
    EXPECT_EQ(files(), "p.png");
}

TEST_F(Tool, ProgressIsShownWhereAskedFor) {
    const std::string slow =
        "render sample:ball:64 --threads 1 --size 384x384 --step 0.02 --early-termination 0 --no-skip-empty -o p.png";
    EXPECT_EQ(tool(slow).err, "");
    EXPECT_NE(tool(slow + " --progress always").err.find("raycast"), std::string::npos);
}

TEST_F(Tool, OptionsAreDocumented) {
    std::ifstream stream(of_project("docs/options.md"));
    const std::string documented{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_EQ(tool("--list-options").out, documented) << "run: chiaro --list-options > docs/options.md";
}

}  // namespace

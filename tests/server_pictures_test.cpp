// Which pictures the server gives, and that they are the tool's.
#include <gtest/gtest.h>

#include "places.h"
#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// What a page's scene is without a server: the same volume and size in a session of its own.
struct Here {
    Here(const Json& shown, const char* volume, int width, int height) {
        std::vector<std::string> unknown;
        scene = parse_scene(shown.dump(), {}, {}, unknown);
        scene.volume = volume, scene.width = width, scene.height = height;
        session.show(read_volume(scene, progress), progress);
    }

    Scene scene;
    Progress progress;
    Session session{Device::cpu(2)};
};

}  // namespace

TEST(ServerImages, RestEndsInTheVeryPixelsThatTheToolRenders) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    scene["sampling"]["samples_per_pixel"] = 4;
    page.send(state(1, scene));
    const auto last = page.of_stage(1, "final");
    ASSERT_TRUE(last);
    EXPECT_EQ(last->json["type"], "png");
    EXPECT_EQ(last->json["size"], Json({64, 48}));
    write_file(server.folder / "final.png", last->image);
    const Image shown = read_png(server.folder / "final.png");
    std::vector<std::string> unknown;
    Scene same = parse_scene(scene.dump(), {}, {}, unknown);
    same.width = 64, same.height = 48;
    Progress progress;
    const Image image = render_image(Device::cpu(2), same, progress);
    EXPECT_TRUE(shown.pixels == image.pixels);
}

TEST(ServerImages, DraftsComeAtOnceAndRestFollowsByItself) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    page.send(state(1, scene, 400, 300, true));
    const auto first = page.find([](const Message& m) { return m.is_frame; });
    ASSERT_TRUE(first);
    EXPECT_EQ(first->json["n"], 1);
    EXPECT_EQ(first->json["type"], "jpeg");
    EXPECT_EQ(first->json["canvas"], Json({400, 300}));
    EXPECT_EQ(first->image.substr(0, 2), "\xff\xd8");
    EXPECT_FALSE(first->json["verbs"].empty());
    EXPECT_TRUE(page.of_stage(1, "final"));
}

TEST(ServerImages, OnlyTheNewestStateCounts) {
    const Server server("sample:shells:96");
    Json scene;
    Page page = server.ready(scene);
    scene["lighting"] = {{"method", "visibility"}};
    constexpr int count = 60;
    for (int n = 1; n <= count; ++n) {
        scene["camera"]["azimuth_deg"] = n;
        scene["transfer_function"]["opacity_scale"] = 1 + 0.01 * n;
        page.send(state(n, scene, 200, 150));
    }
    std::int64_t newest = 0;
    int frames = 0, finals = 0;
    const auto last = page.find([&](const Message& m) {
        if (!m.is_frame) return false;
        EXPECT_GE(m.json["n"].get<std::int64_t>(), newest) << "an older picture after a newer one";
        newest = m.json["n"];
        ++frames;
        finals += m.json["stage"] == "final";
        return m.json["stage"] == "final" && newest == count;
    });
    EXPECT_TRUE(last);
    EXPECT_LT(finals, count / 4) << "of " << frames << " frames: stale work is not given up";
}

TEST(ServerImages, SavedImageRemakesItself) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    scene["output"] = {{"exposure", 0.5}};
    const Json saved = page.ask({{"type", "save"}, {"scene", scene}, {"size", {120, 90}}, {"format", "png"}});
    ASSERT_EQ(saved["type"], "answer") << saved;
    const auto image = http(server.port, "GET", saved["url"]);
    ASSERT_EQ(image.status, 200);
    EXPECT_EQ(image.body.size(), saved["bytes"]);
    EXPECT_NE(image.head.find("attachment; filename=\"ball-32.png\""), std::string::npos) << image.head;
    EXPECT_EQ(http(server.port, "GET", saved["url"]).status, 404) << "offered once";
    write_file(server.folder / "saved.png", image.body);
    const std::string command = built("chiaro") + " render --quiet --scene " + (server.folder / "saved.png").string() +
                                " -o " + (server.folder / "again.png").string();
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_TRUE(file_bytes(server.folder / "again.png") == image.body);
}

/// What the page draws over a saved picture changes the pixels that it covers and no others.
TEST(ServerImages, SavedImagesCarryWhatThePageDrawsOverThem) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const auto red_at = [](int x, int y) { return Json{{"at", {x, y}}, {"png", red_half_clear_png}}; };
    const Json over = Json::array({red_at(10, 20)});
    const auto saved = [&](const Json& overlays, const std::string& format) {
        const Json answer = page.ask(
            {{"type", "save"}, {"scene", scene}, {"size", {60, 45}}, {"format", format}, {"overlays", overlays}});
        EXPECT_EQ(answer["type"], "answer") << answer;
        const fs::path file = server.folder / ("saved." + format);
        write_file(file, http(server.port, "GET", answer["url"]).body);
        return file;
    };
    const auto is_covered = [](int i, int width) { return i % width == 10 && i / width == 20; };
    const auto is_half_covered = [](int i, int width) { return i % width == 11 && i / width == 20; };
    for (const char* background : {"#204060", "transparent"}) {
        scene["background"] = background;
        const Image plain = read_png(saved(Json::array(), "png"));
        const Image drawn = read_png(saved(over, "png"));
        const int parts = plain.has_alpha ? 4 : 3;
        for (int i = 0; i < 60 * 45; ++i)
            for (int c = 0; c < parts; ++c) {
                const int was = plain.pixels[parts * i + c], is = drawn.pixels[parts * i + c];
                const int red = c == 0 || c == 3 ? 255 : 0;
                if (is_covered(i, 60)) {
                    EXPECT_EQ(is, red);
                } else if (!is_half_covered(i, 60)) {
                    EXPECT_EQ(is, was) << i;
                } else if (parts == 3) {
                    EXPECT_NEAR(is, (128 * red + 127 * was) / 255.0, 1);
                }
            }
    }
    const Frame plain = read_exr(saved(Json::array(), "exr")), drawn = read_exr(saved(over, "exr"));
    for (int i = 0; i < 60 * 45; ++i)
        for (int c = 0; c < 4; ++c) {
            const float alpha = is_covered(i, 60) ? 1 : is_half_covered(i, 60) ? 128 / 255.0f : 0;
            const float red = c == 0 || c == 3 ? 1 : 0;
            EXPECT_NEAR(drawn.rgba[4 * i + c], alpha * red + (1 - alpha) * plain.rgba[4 * i + c], 1e-6);
        }
    const auto refused = [&](const Json& overlays) {
        return page.ask({{"type", "save"}, {"scene", scene}, {"size", {60, 45}}, {"overlays", overlays}});
    };
    EXPECT_EQ(refused(Json::array({red_at(59, 0)}))["sentence"],
              "overlays: 2 x 1 at 59, 0 does not lie within 60 x 45");
    Json cut = red_at(0, 0), no_text = cut, nowhere = cut;
    cut["png"] = "iVBORw0KGgo=", no_text["png"] = "!", nowhere.erase("at");
    for (const Json& wrong : {Json("none"), Json::array({cut}), Json::array({no_text}), Json::array({nowhere}),
                              Json::array({"none"}), Json(5, red_at(0, 0))})
        EXPECT_EQ(refused(wrong)["code"], "usage") << wrong;
}

TEST(ServerImages, SavingIsCancelledAndThePageGoesOnMeanwhile) {
    const Server server("sample:shells:64");
    Json scene;
    Page page = server.ready(scene);
    Json large = scene;
    large["sampling"]["samples_per_pixel"] = 256;
    page.send({{"type", "save"}, {"id", 5}, {"scene", large}, {"size", {4000, 3000}}});
    EXPECT_TRUE(page.of_type("progress"));
    page.send(state(1, scene));
    EXPECT_TRUE(page.of_stage(1, "final"));
    page.send({{"type", "cancel"}, {"id", 6}, {"re", 5}});  // which of the two is answered first is open
    const auto ended =
        page.find([](const Message& m) { return !m.is_frame && m.json["re"] == 5 && m.json["type"] != "progress"; });
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->json["code"], "interrupted");
}

TEST(ServerImages, PicksWhatIsSeen) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    EXPECT_EQ(page.ask({{"type", "pick"}, {"x", 32}, {"y", 24}})["hit"], false) << "nothing is shown yet";
    page.send(state(1, scene));
    ASSERT_TRUE(page.of_stage(1, "final"));
    const Json middle = page.ask({{"type", "pick"}, {"x", 32}, {"y", 24}});
    EXPECT_EQ(middle["hit"], true) << middle;
    EXPECT_GT(middle["opacity"], 0);
    EXPECT_EQ(middle["world_mm"].size(), 3u);
    EXPECT_EQ(page.ask({{"type", "pick"}, {"x", 0.5}, {"y", 0.5}})["hit"], false);
}

TEST(ServerImages, TransferFunctionsAndScenesGoOutAndComeBack) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const Json viridis = page.ask({{"type", "resolve"}, {"transfer_function", {{"preset", "viridis"}}}});
    EXPECT_TRUE(viridis["transfer_function"]["points"].is_array());
    scene["transfer_function"] = viridis["transfer_function"];
    scene["camera"]["azimuth_deg"] = 12.5;
    const Json out = page.ask({{"type", "export"}, {"what", "scene"}, {"scene", scene}});
    const Json in = page.ask({{"type", "import"}, {"name", "scene.json"}, {"text", out["text"]}});
    EXPECT_EQ(in["kind"], "scene") << in;
    EXPECT_EQ(in["scene"]["camera"]["azimuth_deg"], 12.5);
    EXPECT_EQ(in["scene"]["transfer_function"]["points"], viridis["transfer_function"]["points"]);
    const Json tf = page.ask({{"type", "export"}, {"what", "transfer"}, {"scene", scene}});
    const Json back = page.ask({{"type", "import"}, {"name", "tf.json"}, {"text", tf["text"]}});
    EXPECT_EQ(back["kind"], "transfer");
    EXPECT_EQ(back["transfer_function"], viridis["transfer_function"]);
    const Json nonsense = page.ask({{"type", "import"}, {"name", "tf.json"}, {"text", "nonsense"}});
    EXPECT_EQ(nonsense["type"], "error");
    const auto upload = http(server.port, "POST", std::string("/upload?view=view-one&name=a.json&token=") + test_token,
                             "", tf["text"].get<std::string>());
    EXPECT_EQ(upload.status, 200);
    EXPECT_EQ(Json::parse(upload.body)["kind"], "transfer");
    EXPECT_EQ(http(server.port, "POST", "/upload?view=view-one&name=a.json&token=no", "", "x").status, 403);
}

TEST(ServerImages, CommandLineMakesTheSameImage) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    scene["camera"]["azimuth_deg"] = -30;
    scene["background"] = "transparent";
    scene["lighting"] = {{"method", "spao"}, {"levels", 4}};
    scene["iso"] = Json::array({{{"value", 50}, {"color", {1, 0, 0}}}, {{"value", 90}, {"opacity", 0.5}}});
    scene["sampling"]["no_skip_empty"] = true;
    scene["image"] = {{"size", {50, 40}}};
    const Json named = page.ask({{"type", "command"}, {"scene", scene}});
    EXPECT_NE(named["text"].get<std::string>().find("--transfer sample:ball"), std::string::npos) << named;
    scene["transfer_function"]["points"].back()["opacity"] = 0.123;
    const Json command = page.ask({{"type", "command"}, {"scene", scene}, {"output", "out.png"}});
    ASSERT_EQ(command["type"], "answer") << command;
    const std::string text = command["text"];
    EXPECT_EQ(text.rfind("cat > transfer.json", 0), 0u) << text;
    const std::string line =
        "cd " + server.folder.string() + " && PATH=" + built(".") + ":$PATH && " + text + " --quiet";
    ASSERT_EQ(std::system(line.c_str()), 0) << text;
    std::vector<std::string> unknown;
    Progress progress;
    const Image image = render_image(Device::cpu(2), parse_scene(scene.dump(), {}, {}, unknown), progress);
    EXPECT_TRUE(read_png(server.folder / "out.png").pixels == image.pixels) << text;
}

TEST(ServerImages, LooksComeAsSmallImages) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    page.send({{"type", "look"}, {"id", 8}, {"scene", scene}, {"size", {128, 96}}});
    const auto look = page.find([](const Message& m) { return m.is_frame && m.json["kind"] == "look"; });
    ASSERT_TRUE(look);
    EXPECT_EQ(look->json["n"], 8);
    EXPECT_EQ(look->json["size"], Json({128, 96}));
    EXPECT_TRUE(page.of_type("answer"));
}

/// One frame of the method, then the reference's, whose paths become more and are never begun anew.
TEST(ServerImages, ComparesWithAReferenceThatGathersPaths) {
    const Server server("sample:ball:16");
    Json scene;
    Page page = server.ready(scene);
    scene["lighting"] = {{"method", "reference"}, {"rays", 16}};
    page.send({{"type", "compare"}, {"id", 4}, {"scene", scene}, {"size", {32, 24}}, {"method", "spao"}});
    std::vector<Message> frames;
    const auto done = page.find([&](const Message& m) {
        if (m.is_frame) frames.push_back(m);
        return !m.is_frame && m.json["re"] == 4 && m.json["type"] != "progress";
    });
    ASSERT_TRUE(done && done->json["type"] == "answer") << (done ? done->json : Json());
    EXPECT_EQ(done->json["figures"]["paths"], 16);
    EXPECT_GT(done->json["figures"]["rmse"], 0);
    EXPECT_LT(done->json["figures"]["rmse"], 0.5);
    ASSERT_GE(frames.size(), 3u);
    EXPECT_EQ(frames.front().json["kind"], "method");
    int paths = 0;
    for (std::size_t i = 1; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].json["n"], 4);
        EXPECT_EQ(frames[i].json["kind"], "reference");
        EXPECT_GT(frames[i].json["samples"], paths);
        EXPECT_EQ(frames[i].json["stage"], i + 1 < frames.size() ? "accumulate" : "final");
        paths = frames[i].json["samples"];
    }
    // The same figures as in one go.
    Here here(scene, "sample:ball:16", 32, 24);
    const MethodComparison once = compare_methods(here.session, here.scene, {Method::spao}, here.progress);
    EXPECT_DOUBLE_EQ(done->json["figures"]["rmse"].get<double>(), once.images.front().distance.rmse);
}

/// "1.8 % from reference": as the library measures it, and a sentence where there is nothing to measure.
TEST(ServerImages, MeasuresHowFarTheLightIsFromTheReference) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    for (const char* method : {"spao", "visibility", "histogram", "transport"}) {
        scene["lighting"] = {{"method", method}};
        if (method == std::string("histogram"))
            scene["lighting"].update({{"cache", "none"}, {"clusters", 64}, {"radius", 6}});
        if (method == std::string("transport")) scene["lighting"]["grid"] = 24;
        const Json found = page.ask({{"type", "measure"}, {"scene", scene}, {"size", {64, 48}}});
        ASSERT_EQ(found["type"], "answer") << found;
        ASSERT_TRUE(found["percent"].is_number()) << method << found;
        EXPECT_EQ(found["points"], 1024);
        EXPECT_LE(found["interval"][0], found["percent"]);
        EXPECT_GE(found["interval"][1], found["percent"]);
        EXPECT_GT(found["largest"], 0);
        EXPECT_LT(found["percent"], 60) << method;
        Here here(scene, "sample:ball:32", 64, 48);
        EXPECT_DOUBLE_EQ(found["percent"].get<double>(),
                         100 * measure_light(here.session, here.scene, here.progress).rmse);
    }
    scene["lighting"] = {{"method", "none"}};
    const Json none = page.ask({{"type", "measure"}, {"scene", scene}});
    EXPECT_TRUE(none["percent"].is_null());
    EXPECT_NE(none["sentence"].get<std::string>().find("not measured"), std::string::npos) << none;
}

/// What would not fit is told before it is tried; a volume that cannot be read by bricks is halved until it fits.
TEST(ServerImages, WhatDoesNotFitIsHalvedOrRefused) {
    setenv("CHIARO_VIEW_MEMORY", "4", 1);  // MiB
    {
        const Server server("");
        const fs::path file = server.folder / "shells.nrrd";
        write_nrrd(make_sample("shells", 96), file, NrrdEncoding::gzip);  // .9 MB; with bricks and light 6.4
        Page page = server.page();
        const Json told = page.ask({{"type", "open"}, {"volume", file.string()}});
        ASSERT_EQ(told["type"], "answer") << told;
        const Json volume = told["volume"];
        Json scene = told["scene"];
        EXPECT_EQ(volume["dimensions"], Json({48, 48, 48}));
        EXPECT_EQ(volume["reduced"]["from"], Json({96, 96, 96}));
        EXPECT_EQ(volume["reduced"]["to"], Json({48, 48, 48}));
        page.send(state(1, scene));
        EXPECT_TRUE(page.of_stage(1, "final"));
        const Json saved = page.ask({{"type", "save"}, {"scene", scene}, {"size", {3000, 2000}}});
        EXPECT_EQ(saved["code"], "memory") << saved;
        EXPECT_EQ(saved["sentence"].get<std::string>().rfind("Needs 0.2 GB, 0.0 GB are free", 0), 0u) << saved;
        scene["lighting"] = {{"method", "visibility"}, {"subsample", 1}, {"storage", "f32"}};  // 8 MB
        page.send(state(2, scene));
        const auto refused = page.of_type("error");
        ASSERT_TRUE(refused);
        EXPECT_EQ(refused->json["code"], "memory");
        EXPECT_EQ(refused->json["n"], 2);
        scene["lighting"]["subsample"] = 4;  // the session lives on, by coarser light
        page.send(state(3, scene));
        EXPECT_TRUE(page.of_stage(3, "final"));
    }
    setenv("CHIARO_VIEW_MEMORY", "0.5", 1);  // not even its voxels, while it is read
    {
        const Server server("");
        const fs::path file = server.folder / "shells.nrrd";
        write_nrrd(make_sample("shells", 96), file, NrrdEncoding::gzip);
        Page page = server.page();
        const Json told = page.ask({{"type", "open"}, {"volume", file.string()}});
        ASSERT_EQ(told["type"], "answer") << told;
        EXPECT_EQ(told["volume"]["reduced"]["from"], Json({96, 96, 96}));
        EXPECT_EQ(told["volume"]["reduced"]["to"], Json({48, 48, 48}));
        EXPECT_EQ(told["volume"]["spacing_mm"], Json({2.0, 2.0, 2.0}));
        EXPECT_EQ(told["volume"]["spacing_stated"], false) << "two of the file's voxels, not of millimetres";
    }
    unsetenv("CHIARO_VIEW_MEMORY");
    const Server server("sample:shells:96");
    Json scene;
    Page page = server.ready(scene);
    const Json half = page.ask({{"type", "open"}, {"half", true}});
    ASSERT_EQ(half["type"], "answer") << half;
    EXPECT_EQ(half["volume"]["dimensions"], Json({48, 48, 48}));
    EXPECT_EQ(half["volume"]["reduced"]["from"], Json({96, 96, 96}));
    page.send(state(1, half["scene"]));
    EXPECT_TRUE(page.of_stage(1, "final"));
}

TEST(ServerImages, MemoryDoesNotGrow) {
    const Server server("sample:shells:48");
    Json scene;
    Page page = server.ready(scene);
    int n = 0;
    const auto drag = [&](int count) {
        for (int i = 0; i < count; ++i) {
            scene["camera"]["azimuth_deg"] = ++n % 360;
            scene["transfer_function"]["opacity_scale"] = 1 + 0.001 * (n % 100);
            page.send(state(n, scene, 160, 120, true));
            const auto seen = page.find([&](const Message& m) { return m.is_frame && m.json["n"] == n; });
            if (!seen) return;
            // As the page does: what the camera fits is found once.
            scene["camera"]["fit_centre"] = seen->json["fit"]["centre"];
            scene["camera"]["fit_radius"] = seen->json["fit"]["radius"];
        }
    };
    drag(150);
    const std::size_t before = resident_bytes();
    drag(300);
    EXPECT_LT(double(resident_bytes()) - double(before), 8e6);
}

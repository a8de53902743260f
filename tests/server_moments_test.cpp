// A volume that changes with time, in a page: which moment each frame shows, and that it is the tool's.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

constexpr int count = 4, size = 24;

/// A ball that grows and becomes brighter, in the server's folder.
std::string write_beat(const fs::path& folder) {
    std::string all = fmt::format(
        "NRRD0005\ntype: uint8\ndimension: 4\nencoding: raw\nsizes: {0} {0} {0} {1}\n"
        "kinds: domain domain domain time\n\n",
        size, count);
    for (int t = 0; t < count; ++t)
        for (int z = 0; z < size; ++z)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const double edge = 5 + t - std::hypot(x - 11.5, y - 11.5, z - 11.5);
                    all += char(std::lround((90 + 30 * t) * std::clamp(edge, 0.0, 1.0)));
                }
    write_file(folder / "beat.nrrd", all);
    return "beat.nrrd";
}

Json at(Json scene, int moment) {
    scene["volume"]["time"] = moment;
    return scene;
}

}  // namespace

TEST(ServerMoments, EveryFullFrameHasVoxelsAndLightOfOneMoment) {
    const Server server("");
    Page page = server.page();
    const Json opened = page.ask({{"type", "open"}, {"volume", write_beat(server.folder)}});
    ASSERT_EQ(opened["type"], "answer") << opened;
    EXPECT_EQ(opened["volume"]["moments"]["count"], count);
    Json scene = opened["scene"];
    scene["lighting"] = {{"method", "visibility"}};
    scene["probe"] = {{"preset", "sky"}};
    int n = 0;
    for (const int moment : {0, 1, 2, 3, 1}) {
        Json wanted = state(++n, at(scene, moment));
        wanted["next"] = (moment + 1) % count;
        page.send(wanted);
        Image final;
        const auto is_last = [&](const Message& m) {
            if (!m.is_frame || m.json["n"] != n) return false;
            EXPECT_EQ(m.json["moment"]["voxels"], moment) << m.json;
            if (m.json["stage"] != "draft") EXPECT_EQ(m.json["moment"]["light"], moment) << m.json;
            return m.json["stage"] == "final";
        };
        const auto last = page.find(is_last);
        ASSERT_TRUE(last);
        if (!scene["camera"].contains("fit_centre"))
            scene["camera"]["fit_centre"] = last->json["fit"]["centre"],
            scene["camera"]["fit_radius"] = last->json["fit"]["radius"];
        write_file(server.folder / "final.png", last->image);
        std::vector<std::string> unknown;
        Scene own = parse_scene(at(scene, moment).dump(), server.folder, {}, unknown);
        own.volume = (server.folder / "beat.nrrd").string();
        own.width = 64, own.height = 48;
        Progress progress;
        EXPECT_TRUE(render_image(Device::cpu(2), own, progress).pixels == read_png(server.folder / "final.png").pixels)
            << moment;
    }
    // What is asked beside it is of the moment that is shown: the value within the ball.
    const Json plane{{"centre", {11, 11, 11}}, {"right", {1, 0, 0}}, {"down", {0, 1, 0}}};
    const Json values = page.ask({{"type", "slice"}, {"plane", plane}, {"size", {1, 1}}, {"values", true}});
    EXPECT_EQ(values["values"], Json({120})) << values;
    const Json saved = page.ask({{"type", "save"}, {"scene", at(scene, 2)}, {"size", {64, 48}}});
    ASSERT_EQ(saved["type"], "answer") << saved;
    write_file(server.folder / "saved.png", http(server.port, "GET", saved["url"]).body);
    std::vector<std::string> unknown;
    EXPECT_EQ(read_scene(server.folder / "saved.png", {}, unknown).read.time, 2);
    Scene own = parse_scene(at(scene, 2).dump(), server.folder, {}, unknown);
    own.volume = (server.folder / "beat.nrrd").string(), own.width = 64, own.height = 48;
    Progress progress;
    EXPECT_TRUE(render_image(Device::cpu(2), own, progress).pixels == read_png(server.folder / "saved.png").pixels);
}

TEST(ServerMoments, OpensAtAMomentAndRefusesOthers) {
    const Server server("");
    Page page = server.page();
    const Json opened = page.ask({{"type", "open"}, {"volume", write_beat(server.folder)}});
    Json wanted = state(1, at(opened["scene"], 9));  // none: the first
    page.send(wanted);
    auto last = page.find([](const Message& m) { return m.is_frame && m.json["stage"] == "final"; });
    ASSERT_TRUE(last);
    EXPECT_EQ(last->json["moment"]["voxels"], 0);
    wanted = state(2, at(opened["scene"], 1));
    wanted["next"] = count;
    page.send(wanted);
    const auto error = page.find([](const Message& m) { return !m.is_frame && m.json["type"] == "error"; });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->json["n"], 2);
    Json scene = opened["scene"];
    scene["volume"] = {{"file", "beat.nrrd"}, {"time", 3}};
    write_file(server.folder / "late.json", scene.dump());
    const Json late = page.ask({{"type", "open"}, {"scene", "late.json"}});
    ASSERT_EQ(late["type"], "answer") << late;
    EXPECT_EQ(late["scene"]["volume"]["time"], 3);
    page.send(state(3, late["scene"]));
    last = page.find([](const Message& m) { return m.is_frame && m.json["n"] == 3 && m.json["stage"] == "final"; });
    ASSERT_TRUE(last);
    EXPECT_EQ(last->json["moment"]["voxels"], 3);
}

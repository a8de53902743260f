// Films of pages: the scene of a moment, and files of all frames.
#include <gtest/gtest.h>

#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

Json film_of(const Json& scene, int keys = 2) {
    Json film{{"film", 1}, {"fps", 10}, {"size", {32, 24}}, {"keys", Json::array()}};
    for (int i = 0; i < keys; ++i) {
        Json own = scene;
        own["camera"]["azimuth_deg"] = 30 * i;
        film["keys"].push_back({{"at", 0.2 * i}, {"scene", own}});
    }
    return film;
}

}  // namespace

TEST(ServerFilm, AMomentIsTheLibrarysFrame) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const Json told = page.ask({{"type", "film_frame"}, {"film", film_of(scene)}, {"seconds", 0.1}});
    ASSERT_EQ(told["type"], "answer") << told;
    EXPECT_EQ(told["frames"], 3);
    EXPECT_EQ(told["frame"], 1);
    EXPECT_NEAR(told["scene"]["camera"]["azimuth_deg"].get<double>(), 15, 1e-9);
    EXPECT_EQ(page.ask({{"type", "film_frame"}, {"film", film_of(scene)}, {"seconds", 99}})["frame"], 2);
}

TEST(ServerFilm, PicturesInAnArchiveCarryTheirScenes) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const Json told = page.ask({{"type", "export_film"}, {"film", film_of(scene)}, {"format", "png"}});
    ASSERT_EQ(told["type"], "answer") << told;
    const std::string archive = http(server.port, "GET", told["url"]).body;
    EXPECT_EQ(archive.size(), told["bytes"]);
    EXPECT_EQ(archive.size() % 512, 0u);
    write_file(server.folder / "film.tar", archive);
    ASSERT_EQ(
        std::system(("tar -xf " + (server.folder / "film.tar").string() + " -C " + server.folder.string()).c_str()), 0);
    for (int frame = 0; frame < 3; ++frame) {
        const fs::path file = server.folder / ("frame-0000" + std::to_string(frame) + ".png");
        std::vector<std::string> unknown;
        const Scene own = read_scene(file, {}, unknown);
        EXPECT_NEAR(own.camera.azimuth_deg, 15 * frame, 1e-9);
        Progress progress;
        EXPECT_TRUE(render_image(Device::cpu(2), own, progress).pixels == read_png(file).pixels);
    }
}

TEST(ServerFilm, WhatIsWrongIsASentence) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const auto refused = [&](const Json& film, const std::string& part, const char* type = "export_film") {
        const Json told = page.ask({{"type", type}, {"film", film}, {"format", "png"}, {"seconds", 0}});
        EXPECT_EQ(told["type"], "error") << told;
        EXPECT_NE(told["sentence"].get<std::string>().find(part), std::string::npos) << told;
    };
    refused(3, "film");
    refused(Json::object(), "\"film\": 1");
    refused({{"film", 1}, {"keys", 7}}, "keys");
    refused({{"film", 1}, {"keys", {{{"scene", 3}}}}}, "keys[0]", "film_frame");
    Json film = film_of(scene);
    film["keys"][1]["at"] = 0;
    refused(film, "keys[1].at");
    film = film_of(scene);
    film["keys"][1]["scene"]["probe"] = {{"file", "/etc/passwd"}};
    refused(film, "outside the folders");
    const Json told = page.ask({{"type", "export_film"}, {"film", film_of(scene)}, {"format", "gif"}});
    EXPECT_EQ(told["sentence"], "format gif: must be mp4, webm or png");
}

TEST(ServerFilm, ACancelledOneLeavesNothing) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    Json film = film_of(scene);
    film["keys"][1]["at"] = 2000;
    page.send({{"type", "export_film"}, {"id", 9}, {"film", film}, {"format", "png"}});
    ASSERT_TRUE(
        page.find([](const Message& m) { return !m.is_frame && m.json["type"] == "progress" && m.json["re"] == 9; }));
    page.send({{"type", "cancel"}, {"id", 10}, {"re", 9}});
    const auto ended =
        page.find([](const Message& m) { return !m.is_frame && m.json["type"] == "error" && m.json["re"] == 9; });
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->json["code"], "interrupted");
}

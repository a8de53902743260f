// The server as pages and others meet it: who gets in, what is answered, what each view keeps.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <future>

#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

TEST(Server, LetsInWhoHasTokenHostAndOrigin) {
    const Server server;
    const int port = server.port;
    const std::string right = test_token, wrong = "ffeeddccbbaa99887766554433221100",
                      local = "http://localhost:" + std::to_string(port);
    EXPECT_EQ(http(port, "GET", "/?token=" + right).status, 200);
    EXPECT_EQ(http(port, "GET", "/").status, 403);
    EXPECT_EQ(http(port, "GET", "/?token=" + wrong).status, 403);
    EXPECT_EQ(http(port, "GET", "/?token=" + right, "", "", "evil.example").status, 403);
    EXPECT_EQ(http(port, "GET", "/?token=" + right, "", "", "127.0.0.1:1").status, 200);  // the end of a tunnel
    EXPECT_EQ(http(port, "GET", "/?token=" + right, "Origin: http://evil.example\r\n").status, 403);
    EXPECT_EQ(http(port, "GET", "/?token=" + right, "Origin: " + local + "\r\n").status, 200);
    EXPECT_EQ(http(port, "GET", "/nothing").status, 404);
    EXPECT_EQ(http(port, "GET", "/../../etc/passwd").status, 404);
    EXPECT_EQ(http(port, "DELETE", "/?token=" + right).status, 405);
    EXPECT_EQ(status_of_socket(port, wrong, "view-one", ""), 403);
    EXPECT_EQ(status_of_socket(port, right, "short", ""), 400);
    EXPECT_EQ(status_of_socket(port, right, "view-one", "Origin: http://evil.example\r\n"), 403);
    EXPECT_NO_THROW(Page(port, right, "view-one", "", "Origin: " + local + "\r\n"));
}

TEST(Server, PageMayLoadNothingFromElsewhere) {
    const Server server;
    const auto page = http(server.port, "GET", std::string("/?token=") + test_token);
    EXPECT_NE(page.head.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
    EXPECT_NE(page.head.find("X-Content-Type-Options: nosniff"), std::string::npos);
    EXPECT_NE(page.head.find("Cache-Control: no-store"), std::string::npos);
    EXPECT_NE(page.head.find("Referrer-Policy: no-referrer"), std::string::npos);
    EXPECT_NE(page.body.find("<html"), std::string::npos);
}

TEST(Server, SaysHelloWithEverySetting) {
    const Server server;
    Page page = server.page();
    const Json hello = page.of_type("hello")->json;
    EXPECT_EQ(hello["protocol"], 1);
    EXPECT_EQ(hello["view"], "view-one");
    std::size_t told = 0, known = 0;
    for (const Json& group : hello["settings"]) told += group["settings"].size();
    const Scene scene;
    for_each_setting([&](const Setting&, const auto&...) { ++known; }, scene);
    EXPECT_EQ(told, known);
    const auto setting = [&](const std::string& flag) {
        for (const Json& group : hello["settings"])
            for (const Json& s : group["settings"])
                if (s["flag"] == flag) return s;
        return Json();
    };
    EXPECT_EQ(setting("step")["default"], 0.5);
    EXPECT_EQ(setting("step")["lowest"], 0.001);
    EXPECT_EQ(setting("step")["kind"], "number");
    EXPECT_EQ(setting("spao-levels")["default"], 7);
    EXPECT_EQ(setting("spao-levels")["method"], "spao");
    EXPECT_EQ(setting("sh-bands")["choices"], Json({"2", "4"}));
    EXPECT_EQ(setting("mode")["choices"], Json({"dvr", "iso", "mip", "minip", "mean", "additive"}));
    EXPECT_EQ(setting("no-skip-empty")["kind"], "switch");
    EXPECT_TRUE(setting("window")["default"].is_null());
    EXPECT_FALSE(hello["presets"].empty());
    EXPECT_FALSE(hello["samples"].empty());
}

TEST(Server, TellsOfTheVolume) {
    const Server server;
    Page page = server.page();
    const auto told = page.find(
        [](const Message& m) { return !m.is_frame && m.json.contains("volume") && m.json["volume"].is_object(); });
    ASSERT_TRUE(told);
    const Json& volume = told->json["volume"];
    EXPECT_EQ(volume["dimensions"], Json({32, 32, 32}));
    std::uint64_t voxels = 0;
    for (const std::uint64_t count : volume["histogram512"]["counts"]) voxels += count;
    EXPECT_EQ(volume["histogram512"]["counts"].size(), 512u);
    EXPECT_EQ(voxels, 32u * 32 * 32);
    EXPECT_TRUE(told->json["scene"]["transfer_function"]["points"].is_array());
}

TEST(Server, LooksFirstFromWhereTheFrameSays) {
    const Server body("sample:torso:24"), other("sample:ball:24");
    Json scene;
    body.ready(scene);
    EXPECT_EQ(scene["camera"]["azimuth_deg"], -55) << "beside the front, to the patient's left";
    EXPECT_EQ(scene["camera"]["elevation_deg"], 15);
    EXPECT_EQ(scene["camera"]["fit"], "visible");
    other.ready(scene);
    EXPECT_EQ(scene["camera"]["azimuth_deg"], 35);
}

TEST(Server, ViewsHaveStatesOfTheirOwn) {
    const Server server;
    Json one, two;
    Page first = server.ready(one, "view-one"), second = server.ready(two, "view-two");
    two["camera"]["azimuth_deg"] = 120;
    first.send(state(1, one));
    second.send(state(1, two));
    const auto a = first.of_stage(1, "final"), b = second.of_stage(1, "final");
    ASSERT_TRUE(a && b);
    one["camera"]["azimuth_deg"] = 120;
    first.send(state(2, one));
    const auto c = first.of_stage(2, "final");
    ASSERT_TRUE(c);
    EXPECT_EQ(b->image, c->image);
}

TEST(Server, ReconnectedViewGetsItsStateBack) {
    const Server server;
    {
        Json scene;
        Page page = server.ready(scene, "view-back");
        scene["camera"]["azimuth_deg"] = 77;
        page.send(state(1, scene));
        ASSERT_TRUE(page.of_stage(1, "final"));
        scene["camera"]["azimuth_deg"] = 99;
        Json trial = state(2, scene);
        trial["preview"] = true;
        page.send(trial);
        EXPECT_EQ(page.ask({{"type", "ping"}})["type"], "answer");
    }
    std::optional<Page> again;
    again.emplace(server.port, test_token, "view-back", "&take=1");
    const Json hello = again->of_type("hello")->json;
    EXPECT_EQ(hello["restored"], true);
    EXPECT_EQ(hello["scene"]["camera"]["azimuth_deg"], 77);
    again->send(state(1, hello["scene"]));
    EXPECT_TRUE(again->of_stage(1, "final"));
}

TEST(Server, SecondPageOfAViewIsToldAndMayTakeOver) {
    const Server server;
    Json scene;
    Page first = server.ready(scene, "view-same");
    Page second = server.page("view-same");
    EXPECT_TRUE(second.of_type("taken"));
    EXPECT_EQ(second.closed(), 4001);
    Page third = server.page("view-same", "&take=1");
    EXPECT_TRUE(third.of_type("hello"));
    EXPECT_TRUE(first.of_type("taken"));
    EXPECT_EQ(first.closed(), 4001);
    EXPECT_EQ(third.ask({{"type", "ping"}})["type"], "answer");
}

TEST(Server, WhatIsNotUnderstoodIsAnswered) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    const auto error = [&](const std::string& text) {
        page.send_raw(1, text);
        const auto answer = page.of_type("error");
        return answer ? answer->json : Json();
    };
    EXPECT_EQ(error("{")["code"], "protocol");
    EXPECT_EQ(error("[]")["code"], "protocol");
    EXPECT_EQ(error("{\"type\": 7}")["code"], "protocol");
    EXPECT_EQ(error("{\"type\": \"save\"}")["code"], "protocol");
    EXPECT_EQ(error(std::string(100000, '['))["code"], "protocol");
    const Json unknown = error(R"({"type": "dance", "id": 3})");
    EXPECT_EQ(unknown["re"], 3);
    EXPECT_EQ(unknown["code"], "protocol");
    EXPECT_EQ(error(R"({"type": "pick", "id": 4, "x": "left", "y": 1})")["re"], 4);
    EXPECT_EQ(page.ask({{"type", "save"}, {"scene", scene}, {"size", {0, 5}}})["code"], "usage");
    EXPECT_EQ(page.ask({{"type", "save"}, {"scene", scene}, {"size", {20000, 5}}})["code"], "usage");

    Json bad = scene;
    bad["sampling"]["step"] = 0;
    page.send(state(5, bad));
    const auto refused = page.of_type("error");
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->json["n"], 5);
    EXPECT_EQ(refused->json["field"], "sampling.step");
    page.send(state(6, scene));  // the session lives on
    EXPECT_TRUE(page.of_stage(6, "final"));
}

TEST(Server, ClosesWhatBreaksTheRulesAndHarmsNobodyElse) {
    const Server server;
    Json scene;
    Page good = server.ready(scene, "view-good");
    {
        Page page = server.page("oversized");
        page.of_type("hello");
        bool is_written = true;
        try {
            page.send_raw(1, std::string(2 << 20, ' '));
        } catch (const std::exception&) {  // closed at the length's sight: the code may be lost with what was under way
            is_written = false;
        }
        const int code = page.closed();
        EXPECT_TRUE(code == 1009 || (!is_written && page.is_over())) << code;
    }
    {
        Page page = server.page("binary--");
        page.of_type("hello");
        page.send_raw(2, "bytes");
        EXPECT_EQ(page.closed(), 1003);
    }
    {
        Page page = server.page("unmasked");
        page.of_type("hello");
        page.send_raw(1, "{}", false);
        EXPECT_EQ(page.closed(), 1002);
    }
    {
        Page page = server.page("no-utf-8");
        page.of_type("hello");
        page.send_raw(1, "{\"\xff\"}");
        EXPECT_EQ(page.closed(), 1007);
    }
    {
        Page page = server.page("too-many");
        page.of_type("hello");
        try {
            for (int i = 0; i < 3000; ++i) page.send({{"type", "ping"}, {"id", i}});
        } catch (const std::exception&) {  // closed while writing
        }
        const int code = page.closed();
        EXPECT_TRUE(code == 1008 || page.is_over()) << code;
    }
    {
        chiaro::testing::Wire wire(server.port);
        wire.write("\x16\x03\x01 nonsense\r\n\r\n");
        wire.read_all(2);
    }
    good.send(state(1, scene));
    EXPECT_TRUE(good.of_stage(1, "final"));
}

TEST(Server, FortyIdleSocketsHinderNobody) {
    const Server server;
    std::vector<Page> idle;
    for (int i = 0; i < 40; ++i) idle.push_back(server.page("idle-view-" + std::to_string(i)));
    Json scene;
    Page page = server.ready(scene);
    page.send(state(1, scene));
    EXPECT_TRUE(page.of_stage(1, "final"));
    for (Page& other : idle) EXPECT_EQ(other.ask({{"type", "ping"}})["type"], "answer");
}

TEST(Server, OpensOnlyWhatLiesInItsFolders) {
    const Server server("");
    Progress progress;
    fs::create_directory(server.folder / "inside");
    write_nrrd(make_sample("slab", 16), server.folder / "inside" / "slab.nrrd", NrrdEncoding::raw);
    fs::create_symlink("/etc", server.folder / "away");
    Page page = server.page();
    EXPECT_TRUE(page.of_type("hello")->json["volume"].is_null());
    page.send(state(1, Json::object()));
    EXPECT_EQ(page.of_type("error")->json["sentence"], "no volume is open");
    const Json roots = page.ask({{"type", "folder"}, {"path", ""}});
    ASSERT_EQ(roots["entries"].size(), 1u);
    const Json listed = page.ask({{"type", "folder"}, {"path", roots["entries"][0]["path"]}});
    EXPECT_EQ(listed["entries"][0]["name"], "away");
    const Json inside = page.ask({{"type", "folder"}, {"path", (server.folder / "inside").string()}});
    EXPECT_EQ(inside["entries"][0]["kind"], "volume");
    for (const char* elsewhere : {"/etc", "../", "inside/../../", "away", "/", "away/ssl"})
        EXPECT_EQ(page.ask({{"type", "folder"}, {"path", elsewhere}})["code"], "input") << elsewhere;
    EXPECT_EQ(page.ask({{"type", "open"}, {"volume", "/etc/passwd"}})["code"], "input");
    EXPECT_EQ(page.ask({{"type", "open"}, {"volume", "-"}})["code"], "input");
    // Folders whose names end as the name of a file does that has parts; a file beside the folder, and its part.
    const fs::path outside = server.folder.string() + "-outside.nrrd";
    fs::copy_file(server.folder / "inside" / "slab.nrrd", outside);
    fs::create_directories(server.folder / "x:" / "y:");
    write_file(server.folder / "x:" / "y", "no volume");
    for (const std::string& way :
         {"x:/../../" + outside.filename().string(), "x:/y:/../../../" + outside.filename().string(),
          "inside/slab.nrrd:/../../../" + outside.filename().string()}) {
        const Json answer = page.ask({{"type", "open"}, {"volume", way}});
        EXPECT_EQ(answer["type"], "error") << way;
        EXPECT_EQ(answer["code"], "input") << way;
    }
    fs::copy_file(outside, server.folder / "x:" / "y:" / "inner.nrrd");
    EXPECT_EQ(page.ask({{"type", "open"}, {"volume", "x:/y:/inner.nrrd"}})["type"], "answer");
    fs::copy_file(outside, server.folder / "x:" / "slab.nrrd");
    EXPECT_EQ(page.ask({{"type", "open"}, {"volume", "x:/slab.nrrd"}})["type"], "answer");
    fs::remove(outside);
    EXPECT_EQ(page.ask({{"type", "open"}, {"volume", "sample:ball:99999"}})["type"], "error");
    const Json opened = page.ask({{"type", "open"}, {"volume", inside["entries"][0]["path"]}});
    ASSERT_EQ(opened["type"], "answer") << opened;
    EXPECT_EQ(opened["volume"]["name"], "slab.nrrd");
    Json scene = opened["scene"];
    page.send(state(2, scene));
    EXPECT_TRUE(page.of_stage(2, "final"));
    scene["probe"] = {{"file", "/etc/passwd.hdr"}};
    page.send(state(3, scene));
    EXPECT_EQ(page.of_type("error")->json["n"], 3);
    scene.erase("probe");
    scene["transfer_function"] = {{"file", "/etc/passwd"}};
    page.send(state(4, scene));
    EXPECT_EQ(page.of_type("error")->json["n"], 4);
}

/// The server begins to read before a page asks: the page is told how far that is, and may give it up.
// A program that is killed cannot remove its folder: the next one does. Who lives holds a lock.
TEST(Server, RemovesWhatKilledOnesLeftBehind) {
    const Server around;  // for a folder to be ours
    setenv("TMPDIR", around.folder.c_str(), 1);
    const auto left = around.folder / "chiaro-view-killed", live = around.folder / "chiaro-view-living",
               fresh = around.folder / "chiaro-view-newone";
    const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(1);
    for (const auto& folder : {left, live, fresh}) {
        fs::create_directories(folder / "uploads");
        write_file(folder / "uploads/a", "a");
        if (folder != fresh) fs::last_write_time(folder, long_ago);
    }
    const int lock = open(live.c_str(), O_RDONLY | O_DIRECTORY);
    ASSERT_EQ(flock(lock, LOCK_EX), 0);
    { const Server next; }
    unsetenv("TMPDIR");
    EXPECT_FALSE(fs::exists(left));
    EXPECT_TRUE(fs::exists(live / "uploads/a"));
    EXPECT_TRUE(fs::exists(fresh / "uploads/a"));
    std::size_t folders = 0;
    for (const auto& entry : fs::directory_iterator(around.folder)) folders += entry.is_directory();
    EXPECT_EQ(folders, 2U) << "its own is gone, too";
    close(lock);
}

TEST(Server, TellsOfTheFirstReadingAndGivesItUp) {
    const Server server("sample:shells:400");
    Page page = server.page();
    const auto hello = page.of_type("hello");
    ASSERT_TRUE(hello);
    EXPECT_EQ(hello->json["reading"], "sample:shells:400");
    EXPECT_TRUE(hello->json["volume"].is_null());
    const auto far = page.of_type("progress");
    ASSERT_TRUE(far);
    EXPECT_EQ(far->json["re"], "open");
    EXPECT_GE(far->json["fraction"], 0);
    page.send({{"type", "cancel"}, {"id", 1}, {"re", "open"}});
    const auto ended = page.find(
        [](const Message& m) { return !m.is_frame && m.json["re"] == "open" && m.json["type"] != "progress"; });
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->json["code"], "interrupted") << ended->json;
    const Json opened = page.ask({{"type", "open"}, {"volume", "sample:ball:16"}});
    EXPECT_EQ(opened["type"], "answer") << opened;
    page.send(state(1, opened["scene"]));
    EXPECT_TRUE(page.of_stage(1, "final"));
}

/// Without a page that asks for the volume.
TEST(Server, TellsWhyTheFirstVolumeCannotBeRead) {
    setenv("CHIARO_VIEW_TOKEN", test_token, 1);
    server::ViewerOptions options;
    options.port = 0, options.device = Device::cpu(2);
    options.scene = scene_of_volume("/nowhere/scan.nrrd");
    std::promise<std::string> told;
    options.unreadable = [&](const std::string& sentence) { told.set_value(sentence); };
    server::Viewer viewer(options);
    auto sentence = told.get_future();
    ASSERT_EQ(sentence.wait_for(std::chrono::seconds(60)), std::future_status::ready);
    EXPECT_NE(sentence.get().find("there is no such file"), std::string::npos);
}

/// What local histograms take in the user's cache, and nothing else that is there.
TEST(Server, TellsAndClearsWhatIsKept) {
    const Server server;
    const char* was = std::getenv("XDG_CACHE_HOME");
    const std::string before = was ? was : "";
    setenv("XDG_CACHE_HOME", server.folder.c_str(), 1);
    const fs::path kept = server.folder / "chiaro";
    Json scene;
    Page page = server.ready(scene);
    EXPECT_EQ(page.ask({{"type", "cache"}})["bytes"], 0) << "a folder that is not there";
    fs::create_directories(kept);
    write_file(kept / "0123.histograms", "seven b");
    write_file(kept / "notes.txt", "not ours");
    const Json told = page.ask({{"type", "cache"}});
    EXPECT_EQ(told["bytes"], 7);
    EXPECT_EQ(told["folder"], kept.string());
    EXPECT_EQ(page.ask({{"type", "cache"}, {"clear", true}})["type"], "answer");
    EXPECT_EQ(page.ask({{"type", "cache"}})["bytes"], 0);
    EXPECT_TRUE(fs::exists(kept / "notes.txt"));
    was ? setenv("XDG_CACHE_HOME", before.c_str(), 1) : unsetenv("XDG_CACHE_HOME");
}

/// The page goes to a far browser in a third of its bytes.
TEST(Server, PacksWhatABrowserAcceptsPacked) {
    const Server server;
    const auto plain = http(server.port, "GET", "/main.js");
    ASSERT_EQ(plain.status, 200);
    EXPECT_EQ(plain.head.find("Content-Encoding"), std::string::npos);
    EXPECT_EQ(http(server.port, "GET", "/main.js", "Accept-Encoding: gzip;q=0\r\n").body, plain.body);
    const auto packed = http(server.port, "GET", "/main.js", "Accept-Encoding: gzip, deflate, br\r\n");
    EXPECT_NE(packed.head.find("Content-Encoding: gzip"), std::string::npos) << packed.head;
    EXPECT_LT(packed.body.size(), plain.body.size() / 2);
    write_file(server.folder / "main.js.gz", packed.body);
    ASSERT_EQ(std::system(("gzip -d " + (server.folder / "main.js.gz").string()).c_str()), 0);
    EXPECT_EQ(file_bytes(server.folder / "main.js"), plain.body);
}

// The server as pages and others meet it: who gets in, what is answered, and which pictures come.
#include <chiaro/chiaro.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "server/serve.h"
#include "web_client.h"

using namespace chiaro;
using chiaro::testing::http;
using chiaro::testing::Json;
using chiaro::testing::Message;
using chiaro::testing::Page;
namespace fs = std::filesystem;

namespace {

constexpr const char* test_token = "00112233445566778899aabbccddeeff";

/// A server of a small ball, in a folder of its own.
class Server {
public:
    explicit Server(const std::string& volume = "sample:ball:32") {
        setenv("CHIARO_VIEW_TOKEN", test_token, 1);
        std::string name = (fs::temp_directory_path() / "chiaro-server-test-XXXXXX").string();
        folder = mkdtemp(name.data());
        server::ViewerOptions options;
        options.folders = {folder};
        options.port = 0;
        options.device = Device::cpu(2);
        if (!volume.empty()) options.scene.emplace().volume = volume;
        viewer.emplace(options);
        port = viewer->port();
        thread = std::thread([this] { viewer->run(false); });
    }
    ~Server() {
        viewer->stop();
        thread.join();
        viewer.reset();
        fs::remove_all(folder);
    }

    Page page(const std::string& view = "view-one", const std::string& rest = "") const {
        return Page(port, test_token, view, rest);
    }
    /// A page that knows its volume; `scene` is what it was told.
    Page ready(Json& scene, const std::string& view = "view-one") const {
        Page page = this->page(view);
        const auto told = page.find(
            [](const Message& m) { return !m.is_frame && m.json.contains("scene") && !m.json["scene"].is_null(); });
        if (told) scene = told->json["scene"];
        return page;
    }

    fs::path folder;
    std::optional<server::Viewer> viewer;
    int port;
    std::thread thread;
};

Json state(int n, const Json& scene, int width = 64, int height = 48, bool moving = false) {
    return {{"type", "state"}, {"n", n}, {"scene", scene}, {"canvas", {width, height}}, {"moving", moving}};
}

std::string file_bytes(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write_file(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

int status_of_socket(int port, const std::string& token, const std::string& view, const std::string& fields) {
    const std::string upgrade =
        "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
        "dGhlIHNhbXBsZSBub25jZQ==\r\n";
    return http(port, "GET", "/socket?token=" + token + "&view=" + view, upgrade + fields).status;
}

std::size_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::size_t pages = 0, resident = 0;
    statm >> pages >> resident;
    return resident * std::size_t(sysconf(_SC_PAGESIZE));
}

}  // namespace

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
    EXPECT_EQ(setting("mode")["choices"], Json({"dvr", "iso", "mip"}));
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

TEST(Server, RestEndsInTheVeryPixelsThatTheToolRenders) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    scene["sampling"]["samples_per_pixel"] = 4;
    page.send(state(1, scene));
    const auto last = page.of_stage(1, "final");
    ASSERT_TRUE(last);
    EXPECT_EQ(last->json["type"], "png");
    EXPECT_EQ(last->json["size"], Json({64, 48}));
    write_file(server.folder / "final.png", last->picture);
    const Image shown = read_png(server.folder / "final.png");
    std::vector<std::string> unknown;
    Scene same = parse_scene(scene.dump(), {}, {}, unknown);
    same.width = 64, same.height = 48;
    Progress progress;
    const Image image = render_image(Device::cpu(2), same, progress);
    EXPECT_TRUE(shown.pixels == image.pixels);
}

TEST(Server, DraftsComeAtOnceAndRestFollowsByItself) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    page.send(state(1, scene, 400, 300, true));
    const auto first = page.find([](const Message& m) { return m.is_frame; });
    ASSERT_TRUE(first);
    EXPECT_EQ(first->json["n"], 1);
    EXPECT_EQ(first->json["type"], "jpeg");
    EXPECT_EQ(first->json["canvas"], Json({400, 300}));
    EXPECT_EQ(first->picture.substr(0, 2), "\xff\xd8");
    EXPECT_FALSE(first->json["verbs"].empty());
    EXPECT_TRUE(page.of_stage(1, "final"));
}

TEST(Server, OnlyTheNewestStateCounts) {
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
    EXPECT_EQ(b->picture, c->picture);
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
        page.send_raw(1, std::string(2 << 20, ' '));
        EXPECT_EQ(page.closed(), 1009);
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

TEST(Server, SavedPictureRemakesItself) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    scene["output"] = {{"exposure", 0.5}};
    const Json saved = page.ask({{"type", "save"}, {"scene", scene}, {"size", {120, 90}}, {"format", "png"}});
    ASSERT_EQ(saved["type"], "answer") << saved;
    const auto picture = http(server.port, "GET", saved["url"]);
    ASSERT_EQ(picture.status, 200);
    EXPECT_EQ(picture.body.size(), saved["bytes"]);
    EXPECT_NE(picture.head.find("attachment; filename=\"ball-32.png\""), std::string::npos) << picture.head;
    EXPECT_EQ(http(server.port, "GET", saved["url"]).status, 404) << "offered once";
    write_file(server.folder / "saved.png", picture.body);
    const std::string command = std::string(CHIARO_BIN) + "/chiaro render --quiet --scene " +
                                (server.folder / "saved.png").string() + " -o " +
                                (server.folder / "again.png").string();
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_TRUE(file_bytes(server.folder / "again.png") == picture.body);
}

TEST(Server, SavingIsCancelledAndThePageGoesOnMeanwhile) {
    const Server server("sample:shells:64");
    Json scene;
    Page page = server.ready(scene);
    Json large = scene;
    large["sampling"]["samples_per_pixel"] = 256;
    page.send({{"type", "save"}, {"id", 5}, {"scene", large}, {"size", {4000, 3000}}});
    EXPECT_TRUE(page.of_type("progress"));
    page.send(state(1, scene));
    EXPECT_TRUE(page.of_stage(1, "final"));
    EXPECT_EQ(page.ask({{"type", "cancel"}, {"re", 5}})["type"], "answer");
    const auto ended =
        page.find([](const Message& m) { return !m.is_frame && m.json["re"] == 5 && m.json["type"] != "progress"; });
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->json["code"], "interrupted");
}

TEST(Server, PicksWhatIsSeen) {
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
    EXPECT_EQ(page.ask({{"type", "open"}, {"volume", "sample:ball:4096"}})["type"], "error");
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

TEST(Server, TransferFunctionsAndScenesGoOutAndComeBack) {
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
    EXPECT_EQ(in["scene"]["transfer_function"], viridis["transfer_function"]);
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

TEST(Server, CommandLineMakesTheSamePicture) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    scene["camera"]["azimuth_deg"] = -30;
    scene["background"] = "transparent";
    scene["lighting"] = {{"method", "spao"}, {"levels", 4}};
    scene["iso"] = Json::array({{{"value", 50}, {"color", {1, 0, 0}}}, {{"value", 90}, {"opacity", 0.5}}});
    scene["sampling"]["no_skip_empty"] = true;
    scene["image"] = {{"size", {50, 40}}};
    const Json command = page.ask({{"type", "command"}, {"scene", scene}, {"output", "out.png"}});
    ASSERT_EQ(command["type"], "answer") << command;
    const std::string text = command["text"];
    EXPECT_EQ(text.rfind("cat > transfer.json", 0), 0u) << text;
    const std::string line = "cd " + server.folder.string() + " && PATH=" CHIARO_BIN ":$PATH && " + text + " --quiet";
    ASSERT_EQ(std::system(line.c_str()), 0) << text;
    std::vector<std::string> unknown;
    Progress progress;
    const Image image = render_image(Device::cpu(2), parse_scene(scene.dump(), {}, {}, unknown), progress);
    EXPECT_TRUE(read_png(server.folder / "out.png").pixels == image.pixels) << text;
}

TEST(Server, LooksComeAsSmallPictures) {
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

TEST(Server, ComparesWithTheReference) {
    const Server server("sample:ball:16");
    Json scene;
    Page page = server.ready(scene);
    scene["lighting"] = {{"method", "reference"}, {"rays", 16}};
    const Json done = page.ask({{"type", "compare"}, {"scene", scene}, {"size", {32, 24}}, {"method", "spao"}});
    ASSERT_EQ(done["type"], "answer") << done;
    EXPECT_EQ(done["figures"]["paths"], 16);
    EXPECT_GT(done["figures"]["rmse"], 0);
    EXPECT_LT(done["figures"]["rmse"], 0.5);
}

TEST(Server, MemoryDoesNotGrow) {
    const Server server("sample:shells:48");
    Json scene;
    Page page = server.ready(scene);
    int n = 0;
    const auto drag = [&](int count) {
        for (int i = 0; i < count; ++i) {
            scene["camera"]["azimuth_deg"] = ++n % 360;
            scene["transfer_function"]["opacity_scale"] = 1 + 0.001 * (n % 100);
            page.send(state(n, scene, 160, 120, true));
            page.find([&](const Message& m) { return m.is_frame && m.json["n"] == n; });
        }
    };
    drag(150);
    const std::size_t before = resident_bytes();
    drag(300);
    EXPECT_LT(double(resident_bytes()) - double(before), 8e6);
}

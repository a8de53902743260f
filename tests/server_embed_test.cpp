// The server within another program: keys for one visit, proxies, frames, and a scene that both sides change.
#include <chiaro/error.h>
#include <chiaro/session.h>
#include <chiaro/view.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

/// A sample in memory, served.
struct Embedded {
    std::shared_ptr<const Volume> volume = std::make_shared<Volume>(make_sample("ball", 32));
    ViewSettings settings{.device = Device::cpu(2)};
    std::mutex mutex;
    std::condition_variable heard;
    int states = 0;

    Embedded() {
        settings.scene.volume = volume->source;
        settings.volume = volume;
        settings.changed = [this](const Scene&) {
            const std::lock_guard lock(mutex);
            ++states;
            heard.notify_all();
        };
    }
    bool wait_for_states(int count) {
        std::unique_lock lock(mutex);
        return heard.wait_for(lock, std::chrono::seconds(30), [&] { return states >= count; });
    }
};

std::string visit_token(const std::string& page) {
    const std::string mark = "<meta name=\"chiaro-visit\" content=\"";
    const std::size_t at = page.find(mark);
    return at == page.npos ? "" : page.substr(at + mark.size(), 32);
}

/// What the upgrade to a WebSocket is answered with.
int upgrade(int port, const std::string& target, const std::string& host = "localhost",
            const std::string& origin = "") {
    Wire wire(port);
    wire.write("GET " + target + " HTTP/1.1\r\nHost: " + host +
               "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
               "dGhlIHNhbXBsZSBub25jZQ==\r\n" +
               (origin.empty() ? "" : "Origin: " + origin + "\r\n") + "\r\n");
    const auto head = wire.read_until("\r\n\r\n", 20);
    return head && head->size() > 12 ? std::stoi(head->substr(9, 3)) : 0;
}
std::string socket_path(const std::string& token) { return "/socket?view=view-one&take=1&token=" + token; }

std::string token_of(const std::string& url) { return url.substr(url.find("token=") + 6); }

}  // namespace

TEST(Embed, AKeyIsGoodForOneVisitAndThePageSpeaksOn) {
    Embedded e;
    ViewServer server(e.settings);
    EXPECT_EQ(http(server.port(), "GET", "/").status, 403);
    const std::string path = server.path_of_one_visit();
    EXPECT_EQ(path.find(token_of(server.url())), path.npos);
    const Answer first = http(server.port(), "GET", path);
    ASSERT_EQ(first.status, 200);
    const std::string token = visit_token(first.body);
    EXPECT_EQ(token.size(), 32u);
    EXPECT_NE(token, token_of(server.url()));
    EXPECT_EQ(first.body.find(token_of(server.url())), first.body.npos);
    EXPECT_EQ(http(server.port(), "GET", path).status, 403) << "a second visit";
    EXPECT_EQ(http(server.port(), "GET", "/?key=00112233445566778899aabbccddeeff").status, 403);
    EXPECT_EQ(upgrade(server.port(), socket_path(token)), 101);
    EXPECT_EQ(upgrade(server.port(), socket_path(path.substr(6))), 403);
    EXPECT_NE(server.path_of_one_visit(), path);
}

TEST(Embed, AProxysPathMayStandBeforeEveryAddress) {
    Embedded e;
    e.settings.base_path = "/user/ann/proxy/1/";
    ViewServer server(e.settings);
    const std::string path = server.path_of_one_visit();
    EXPECT_TRUE(path.starts_with("/user/ann/proxy/1/?key="));
    const std::string token = visit_token(http(server.port(), "GET", path).body);
    EXPECT_EQ(http(server.port(), "GET", "/user/ann/proxy/1/style.css").status, 200);
    EXPECT_EQ(http(server.port(), "GET", "/style.css").status, 200) << "where the proxy takes it away";
    EXPECT_EQ(http(server.port(), "GET", "/user/ann/style.css").status, 404);
    EXPECT_EQ(upgrade(server.port(), "/user/ann/proxy/1" + socket_path(token)), 101);
    EXPECT_EQ(upgrade(server.port(), "/user/ann" + socket_path(token)), 404);
}

TEST(Embed, OnlyOriginsThatWereNamedMayFrameAndAsk) {
    Embedded e;
    struct Visitor {
        const char *host, *origin;
        bool is_of_hub;
    };
    const Visitor visitors[] = {{"hub.example.org", "https://hub.example.org", true},
                                {"localhost", "https://hub.example.org", true},
                                {"localhost", "https://example.org", false},
                                {"localhost", "http://hub.example.org", false},
                                {"example.org", "", false}};
    const auto frames = [](const ViewServer& server) {
        const std::string head = http(server.port(), "GET", "/style.css").head;
        const std::size_t at = head.find("frame-ancestors ");
        return head.substr(at + 16, head.find("\r\n", at) - at - 16);
    };
    const auto expect = [&](const ViewServer& server, bool lets_hub_in) {
        for (const Visitor& v : visitors)
            EXPECT_EQ(upgrade(server.port(), socket_path(token_of(server.url())), v.host, v.origin),
                      v.is_of_hub && lets_hub_in ? 101 : 403)
                << v.host << " " << v.origin;
    };
    {
        const ViewServer closed(e.settings);
        EXPECT_EQ(frames(closed), "'none'");
        expect(closed, false);
    }
    e.settings.embed_from = {"https://hub.example.org", "http://localhost:8888"};
    const ViewServer open(e.settings);
    EXPECT_EQ(frames(open), "https://hub.example.org http://localhost:8888");
    expect(open, true);
}

TEST(Embed, RefusesWhatIsNoOriginAndNoPath) {
    Embedded e;
    for (const char* wrong : {"hub.org", "https://", "https://a.org/x", "https://a.org; script-src *", "*", ""}) {
        e.settings.embed_from = {wrong};
        EXPECT_THROW(ViewServer{e.settings}, Error) << wrong;
    }
    e.settings.embed_from.clear();
    for (const char* wrong : {"", "proxy/", "/proxy", "/a b/", "/a?b/"}) {
        e.settings.base_path = wrong;
        EXPECT_THROW(ViewServer{e.settings}, Error) << wrong;
    }
}

TEST(Embed, BothSidesChangeTheScene) {
    Embedded e;
    ViewServer server(e.settings);
    EXPECT_EQ(server.scene().camera.azimuth_deg, 35);
    Page page(server.port(), token_of(server.url()), "view-one", "");
    Json scene;
    const auto told = page.find(
        [](const Message& m) { return !m.is_frame && m.json.contains("scene") && !m.json["scene"].is_null(); });
    ASSERT_TRUE(told);
    scene = told->json["scene"];
    scene["camera"]["azimuth_deg"] = 80;
    page.send(state(1, scene));
    EXPECT_TRUE(page.of_stage(1, "final"));
    ASSERT_TRUE(e.wait_for_states(1));
    EXPECT_EQ(server.scene().camera.azimuth_deg, 80) << "the page's choice";

    Scene wanted = server.scene();
    wanted.camera.azimuth_deg = -20;
    server.put(wanted);
    const auto put = page.of_type("put");
    ASSERT_TRUE(put);
    EXPECT_EQ(put->json["scene"]["camera"]["azimuth_deg"], -20);
    EXPECT_EQ(server.scene().camera.azimuth_deg, -20);
    Page another(server.port(), token_of(server.url()), "view-two", "");
    const auto later = another.find([](const Message& m) {
        return !m.is_frame && m.json.contains("scene") && !m.json["scene"].is_null() &&
               m.json["scene"]["camera"]["azimuth_deg"] == -20;
    });
    EXPECT_TRUE(later) << "a page that comes later sees it too";
    server.stop();
    server.stop();
    EXPECT_EQ(e.volume->voxels.size(), 32u * 32 * 32);
}

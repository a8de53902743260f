// What those who have no token can do to the server: nothing that others notice.
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

const std::string page_path = std::string("/?token=") + test_token;

std::unique_ptr<Wire> asking(int port, const std::string& head) {
    auto wire = std::make_unique<Wire>(port);
    wire->write(head);
    return wire;
}

}  // namespace

// The body never ends; it is not read.
TEST(Gate, NoBodyOfAStrangerIsRead) {
    const Server server;
    const std::string host = "Host: localhost:" + std::to_string(server.port) + "\r\n";
    const std::size_t before = resident_bytes();
    for (const std::string method : {"GET", "HEAD", "POST"})
        for (const std::string length : {"Transfer-Encoding: chunked\r\n", "Content-Length: 60000000\r\n"})
            for (const std::string path : {"/", "/nothing", "/upload?view=view-one&name=a.json", "/download/abc"}) {
                const auto wire = asking(server.port, method + " " + path + " HTTP/1.1\r\n" + host + length + "\r\n");
                const std::string answer = wire->read_all(20);
                EXPECT_TRUE(answer.starts_with("HTTP/1.1 4")) << method << path << length << answer;
                // With the whole body read there would have been no answer yet.
                EXPECT_TRUE(wire->is_over()) << method << path << length;
            }
    EXPECT_LT(double(resident_bytes()) - double(before), 20e6);
    EXPECT_EQ(http(server.port, "GET", page_path).status, 200);
}

// More than there are places, all of which say nothing: the oldest make room.
TEST(Gate, IdleStrangersKeepNobodyOut) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    std::vector<std::unique_ptr<Wire>> idle;
    for (int i = 0; i < 300; ++i) idle.push_back(asking(server.port, i % 2 ? "" : "GET / HT"));
    EXPECT_EQ(http(server.port, "GET", page_path).status, 200);
    Page other = server.page("view-two");
    EXPECT_TRUE(other.of_type("hello"));
    page.send(state(1, scene));
    EXPECT_TRUE(page.of_stage(1, "final"));
    std::size_t open = 0;
    for (const auto& wire : idle) wire->read_all(0), open += !wire->is_over();
    EXPECT_LE(open, 64u);
}

// A megabyte of unknown keys keeps its own page busy: others are answered meanwhile.
TEST(Gate, ALongMessageHoldsUpNobodyElse) {
    const Server server;
    Json scene;
    Page long_winded = server.ready(scene, "view-long"), other = server.page("view-other");
    for (int i = 0; i < 40000; ++i) scene["unknown-" + std::to_string(i)] = i;
    const Json request{{"type", "command"}, {"scene", scene}};
    const auto seconds_of = [](Page& page, const Json& asked) {
        const auto start = std::chrono::steady_clock::now();
        EXPECT_EQ(page.ask(asked)["type"], "answer");
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    std::vector<double> alone, beside;
    for (int i = 0; i < 3; ++i) alone.push_back(seconds_of(long_winded, request));
    Json numbered = request;
    numbered["id"] = 1000;
    const std::string text = numbered.dump();
    std::thread talking([&] {
        for (int i = 0; i < 20; ++i) long_winded.send_raw(1, text);
    });
    for (int i = 0; i < 9; ++i) beside.push_back(seconds_of(other, {{"type", "ping"}}));
    talking.join();
    std::sort(alone.begin(), alone.end()), std::sort(beside.begin(), beside.end());
    EXPECT_LT(beside[4], alone[1] / 3);
}

// A file of very many keys is refused or answered, in little memory.
TEST(Gate, AFileOfManyKeysIsRefusedInASentence) {
    const Server server;
    Json scene;
    Page page = server.ready(scene);
    std::string keys = "{\"camera\": {}";
    for (int i = 0; i < 700000; ++i) keys += ", \"k" + std::to_string(i) + "\": 0";
    const std::size_t before = resident_bytes();
    const Answer answer =
        http(server.port, "POST", std::string("/upload?view=view-one&name=a.json&token=") + test_token, "", keys + "}");
    EXPECT_EQ(answer.status, 422);
    EXPECT_NE(answer.body.find("may have at most 4 MiB"), std::string::npos) << answer.body;
    EXPECT_LT(double(resident_bytes()) - double(before), 100e6);
}

// What a page says comes back cut and harmless.
TEST(Gate, MessagesRepeatLittleAndNothingThatATerminalObeys) {
    const Server server;
    Page page = server.page();
    const Json answer = page.ask({{"type", "open"}, {"volume", "\x1b[31m\u202e" + std::string(100000, 'x')}});
    const std::string sentence = answer["sentence"];
    EXPECT_EQ(answer["code"], "input");
    EXPECT_LT(sentence.size(), 3000u);
    EXPECT_EQ(sentence.find('\x1b'), std::string::npos);
    EXPECT_EQ(sentence.find("\u202e"), std::string::npos);
}

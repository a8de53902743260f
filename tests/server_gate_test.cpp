// What those who have no token can do to the server: nothing that others notice.
#include <gtest/gtest.h>

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

// Volumes that pages send: streamed, limited, named, opened, and gone.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

std::string nrrd_bytes(int size) {
    std::string text = "NRRD0004\ntype: unsigned char\ndimension: 3\nsizes: " + std::to_string(size) + " " +
                       std::to_string(size) + " " + std::to_string(size) + "\nencoding: raw\n\n";
    for (int i = 0; i < size * size * size; ++i) text += char(i % 251);
    return text;
}

std::string address(const std::string& volume, const std::string& name, const std::string& token = test_token) {
    return "/volume?view=view-one&volume=" + volume + "&name=" + name + "&token=" + token;
}

}  // namespace

class ServerUpload : public ::testing::Test {
protected:
    ServerUpload() {
        std::string name = (fs::temp_directory_path() / "chiaro-upload-test-XXXXXX").string();
        cache = mkdtemp(name.data());
        setenv("XDG_CACHE_HOME", cache.c_str(), 1);
    }
    ~ServerUpload() override {
        unsetenv("XDG_CACHE_HOME");
        fs::remove_all(cache);
    }
    std::vector<fs::path> files() const {
        std::vector<fs::path> found;
        for (const auto& entry : fs::recursive_directory_iterator(cache))
            if (entry.is_regular_file()) found.push_back(entry.path());
        return found;
    }
    fs::path cache;
};

TEST_F(ServerUpload, AFileIsKeptOpenedAndGoneAtTheEnd) {
    {
        const Server server("");
        Page page = server.page();
        const std::string bytes = nrrd_bytes(16);
        const auto sent = http(server.port, "POST", address("volume-1", "scan.nrrd"), "", bytes);
        ASSERT_EQ(sent.status, 200) << sent.body;
        EXPECT_EQ(Json::parse(sent.body)["bytes"], bytes.size());
        ASSERT_EQ(files().size(), 1u);
        EXPECT_EQ(files()[0].filename(), "scan.nrrd");
        EXPECT_TRUE(file_bytes(files()[0]) == bytes);
        EXPECT_EQ(fs::status(files()[0].parent_path().parent_path()).permissions(), fs::perms::owner_all);
        const Json opened = page.ask({{"type", "open"}, {"uploaded", "volume-1"}});
        ASSERT_EQ(opened["type"], "answer") << opened;
        EXPECT_EQ(opened["volume"]["name"], "scan.nrrd");
        EXPECT_EQ(opened["volume"]["dimensions"], Json({16, 16, 16}));
        page.send(state(1, opened["scene"]));
        EXPECT_TRUE(page.of_stage(1, "final"));
    }
    EXPECT_TRUE(files().empty());
}

TEST_F(ServerUpload, SeveralFilesAreAHeaderWithItsDataOrAFolder) {
    const Server server("");
    Page page = server.page();
    const std::string header =
        "NRRD0004\ntype: unsigned char\ndimension: 3\nsizes: 8 8 8\nencoding: raw\ndata file: bytes.raw\n";
    ASSERT_EQ(http(server.port, "POST", address("volume-2", "scan.nhdr"), "", header).status, 200);
    ASSERT_EQ(http(server.port, "POST", address("volume-2", "bytes.raw"), "", std::string(512, 'x')).status, 200);
    const Json opened = page.ask({{"type", "open"}, {"uploaded", "volume-2"}});
    ASSERT_EQ(opened["type"], "answer") << opened;
    EXPECT_EQ(opened["volume"]["dimensions"], Json({8, 8, 8}));
    // What is no volume ends in the helper's sentence.
    ASSERT_EQ(http(server.port, "POST", address("volume-3", "IM1"), "", "no slice").status, 200);
    ASSERT_EQ(http(server.port, "POST", address("volume-3", "IM2"), "", "no slice").status, 200);
    const Json refused = page.ask({{"type", "open"}, {"uploaded", "volume-3"}});
    EXPECT_EQ(refused["type"], "error");
    EXPECT_EQ(refused["code"], "input");
    EXPECT_GT(refused["sentence"].get<std::string>().size(), 20u);
    EXPECT_EQ(page.ask({{"type", "discard"}, {"uploaded", "volume-3"}})["type"], "answer");
    for (const fs::path& file : files()) EXPECT_NE(file.filename(), "IM1");
    EXPECT_EQ(page.ask({{"type", "open"}, {"uploaded", "volume-3"}})["code"], "usage");
    EXPECT_EQ(page.ask({{"type", "open"}, {"uploaded", "nothing-of-it"}})["code"], "usage");
}

TEST_F(ServerUpload, NamesLeadNowhereElse) {
    const Server server("");
    Page page = server.page();
    for (const char* name :
         {"..%2F..%2Fescaped", "%2Fetc%2Fescaped", "a%2F..%2F..%2Fescaped", ".escaped", "a%00b", "a%0Ab"})
        EXPECT_EQ(http(server.port, "POST", address("volume-4", name), "", "x").status, 200) << name;
    EXPECT_EQ(files().size(), 6u);
    for (const fs::path& file : files()) {
        EXPECT_EQ(file.parent_path(), files()[0].parent_path());
        EXPECT_NE(file.filename().string().front(), '.');
    }
    EXPECT_EQ(http(server.port, "POST", address("volume-4", ".."), "", "x").status, 413);
    EXPECT_EQ(http(server.port, "POST", address("volume-4", ""), "", "x").status, 413);
    EXPECT_EQ(http(server.port, "POST", address("..", "a"), "", "x").status, 400);
    EXPECT_EQ(http(server.port, "POST", address("volume-4", "a", "no"), "", "x").status, 403);
    // The same name again is another file.
    EXPECT_EQ(http(server.port, "POST", address("volume-4", "twice"), "", "x").status, 200);
    EXPECT_EQ(http(server.port, "POST", address("volume-4", "twice"), "", "y").status, 200);
    EXPECT_EQ(files().size(), 8u);
    EXPECT_EQ(http(server.port, "GET", address("volume-4", "twice")).status, 404);
}

TEST_F(ServerUpload, WhatIsTooLargeOrBreaksOffLeavesNothing) {
    setenv("CHIARO_VIEW_TOKEN", test_token, 1);
    server::ViewerOptions options;
    options.folders = {cache};
    options.port = 0, options.device = Device::cpu(1), options.max_upload = 1000;
    server::Viewer viewer(options);
    std::thread thread([&] { viewer.run(false); });
    const auto too_large = http(viewer.port(), "POST", address("volume-5", "a"), "", std::string(1001, 'x'));
    EXPECT_EQ(too_large.status, 413);
    EXPECT_EQ(too_large.body, "A volume may have at most 1.0 KiB (--max-upload).\n");
    EXPECT_EQ(http(viewer.port(), "POST", address("volume-5", "a"), "", std::string(600, 'x')).status, 200);
    EXPECT_EQ(http(viewer.port(), "POST", address("volume-5", "b"), "", std::string(600, 'x')).status, 413);
    {
        Wire broken(viewer.port());
        broken.write("POST " + address("volume-6", "half") +
                     " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 900\r\n\r\n" + std::string(100, 'x'));
        for (int i = 0; i < 500 && files().size() < 2; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
        EXPECT_EQ(files().size(), 2u);
    }
    for (int i = 0; i < 500 && files().size() > 1; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(files().size(), 1u) << "the part that came is gone";
    EXPECT_EQ(http(viewer.port(), "POST", address("volume-6", "whole"), "", std::string(900, 'x')).status, 200)
        << "what broke off does not count";
    viewer.stop();
    thread.join();
}

TEST_F(ServerUpload, AFullDiskIsASentenceAndLeavesNothing) {
    if (mount("none", cache.c_str(), "tmpfs", 0, "size=72m,mode=700") != 0) GTEST_SKIP() << "needs the right to mount";
    struct Unmount {
        const fs::path& disk;
        ~Unmount() { umount2(disk.c_str(), MNT_DETACH); }
    } unmount{cache};
    const Server server("");
    Page page = server.page();
    // What would not fit is refused before it comes: the disk keeps 64 MiB.
    const auto refused = http(server.port, "POST", address("volume-8", "large.raw"), "", std::string(16 << 20, 'x'));
    EXPECT_EQ(refused.status, 413);
    EXPECT_EQ(refused.body, "The disk has no room: 16.0 MiB are sent, 72.0 MiB are free.\n");
    EXPECT_TRUE(files().empty());
    EXPECT_EQ(page.ask({{"type", "room"}, {"bytes", 16 << 20}, {"files", 1}})["code"], "output");
    EXPECT_EQ(page.ask({{"type", "room"}, {"bytes", 4 << 20}, {"files", 20001}})["code"], "usage");
    EXPECT_EQ(page.ask({{"type", "room"}, {"bytes", 4 << 20}, {"files", 1}})["type"], "answer");
    // Others fill the disk while it comes.
    constexpr std::size_t whole = 4 << 20, part = 1 << 20;
    const std::string piece(part, 'x');
    Wire connection(server.port);
    connection.write("POST " + address("volume-9", "scan.raw") +
                     " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(whole) + "\r\n\r\n" + piece);
    for (int i = 0; i < 500 && (files().empty() || fs::file_size(files()[0]) < part); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_EQ(files().size(), 1u);
    std::ofstream filler(cache / "filler", std::ios::binary);
    while (filler.write(piece.data(), std::streamsize(part)).flush()) {
    }
    filler.close();
    try {
        for (std::size_t sent = part; sent < whole; sent += part) connection.write(piece);
    } catch (const std::runtime_error&) {  // it is not read to its end
    }
    const std::string answer = connection.read_all(20);
    EXPECT_NE(answer.find(" 507 "), answer.npos) << answer;
    EXPECT_NE(answer.find("The disk is full."), answer.npos) << answer;
    for (int i = 0; i < 500 && files().size() > 1; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_EQ(files().size(), 1u);
    EXPECT_EQ(files()[0].filename(), "filler");
    EXPECT_EQ(page.ask({{"type", "open"}, {"uploaded", "volume-9"}})["code"], "usage");
    // With room again it is taken.
    fs::remove(cache / "filler");
    EXPECT_EQ(http(server.port, "POST", address("volume-9", "scan.raw"), "", piece).status, 200);
}

TEST_F(ServerUpload, MoreThanIsHeldInMemoryIsNeverHeldInMemory) {
    const Server server("");
    Page page = server.page();
    constexpr std::size_t whole = 160 << 20, part = 1 << 20;
    Wire connection(server.port);
    connection.write("POST " + address("volume-7", "large.raw") +
                     " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(whole) + "\r\n\r\n");
    const std::string piece(part, 'x');
    const std::size_t before = resident_bytes();
    std::size_t most = 0;
    for (std::size_t sent = 0; sent < whole; sent += part) {
        connection.write(piece);
        most = std::max(most, resident_bytes());
    }
    const auto head = connection.read_until("\r\n", 60);
    ASSERT_TRUE(head);
    EXPECT_NE(head->find(" 200 "), std::string::npos) << *head;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which keep memory of their own
    EXPECT_LT(most, before + (40 << 20));
#endif
    ASSERT_EQ(files().size(), 1u);
    EXPECT_EQ(fs::file_size(files()[0]), whole);
}

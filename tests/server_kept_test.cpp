// What is kept of views on disk: found again by another server, private, old ones gone, damaged ones passed over.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/kept_views.h"
#include "server_case.h"

using namespace chiaro;
using namespace chiaro::testing;
using server::KeptView;
using server::KeptViews;

namespace {

struct Folder {
    Folder() {
        std::string name = (fs::temp_directory_path() / "chiaro-kept-test-XXXXXX").string();
        path = mkdtemp(name.data());
    }
    ~Folder() { fs::remove_all(path); }
    fs::path views() const { return path / "chiaro/views"; }
    fs::path path;
};

KeptView view(const std::string& id, const std::string& volume, int n) {
    return {id, volume, {{"n", n}}, {{"undo", {{"design", Json::array()}}}}, 0};
}

}  // namespace

TEST(ServerKept, TheNewestIsWrittenPrivateAndFoundAgain) {
    const Folder folder;
    {
        KeptViews kept(folder.views());
        for (int i = 0; i <= 100; ++i) kept.note(view("view-one", "scan.nrrd", i));
        kept.note(view("view-two", "other.nrrd", 7));
        EXPECT_EQ(kept.find("view-one")->scene["n"], 100);
    }  // at its end what waits is written
    const KeptViews again(folder.views());
    ASSERT_TRUE(again.find("view-one"));
    EXPECT_EQ(again.find("view-one")->scene["n"], 100);
    EXPECT_TRUE(again.find("view-one")->undo["undo"].is_object());
    EXPECT_FALSE(again.find("view-none"));
    EXPECT_EQ(again.newest_of("other.nrrd", "view-one")->view, "view-two");
    EXPECT_FALSE(again.newest_of("other.nrrd", "view-two"));
    EXPECT_EQ(fs::status(folder.views()).permissions(), fs::perms::owner_all);
    for (const auto& entry : fs::directory_iterator(folder.views()))
        EXPECT_EQ(fs::status(entry).permissions(), fs::perms::owner_read | fs::perms::owner_write) << entry;
}

TEST(ServerKept, IsOnDiskWithinASecondWhileItGoesOn) {
    const Folder folder;
    KeptViews kept(folder.views());
    kept.note(view("view-one", "scan.nrrd", 1));
    kept.note(view("view-one", "scan.nrrd", 2));
    const auto on_disk = [&] {
        const KeptViews reader(folder.views());
        const auto found = reader.find("view-one");
        return found ? found->scene["n"].get<int>() : 0;
    };
    for (int i = 0; i < 1000 && on_disk() != 2; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(on_disk(), 2);
}

/// Also while it is just being written.
TEST(ServerKept, WhatWasNotedIsFoundFromThenOn) {
    const Folder folder;
    for (int time = 0; time < 1000; ++time) {
        KeptViews kept(folder.views());
        kept.note(view("view-one", "scan.nrrd", time));
        for (int look = 0; look < 20; ++look) {
            const auto found = kept.find("view-one");
            ASSERT_TRUE(found && found->scene["n"] == time) << "time " << time << ", look " << look;
            const auto newest = kept.newest_of("scan.nrrd", "view-two");
            ASSERT_TRUE(newest && newest->scene["n"] == time) << "time " << time << ", look " << look;
        }
    }
}

TEST(ServerKept, OldAndDamagedOnesAreAsIfTheyWereNot) {
    const Folder folder;
    {
        KeptViews kept(folder.views());
        for (const char* id : {"view-old", "view-cut", "view-odd", "view-new"}) kept.note(view(id, "scan.nrrd", 1));
    }
    const auto file = [&](const std::string& id) { return folder.views() / (id + ".view.json"); };
    fs::last_write_time(file("view-old"), fs::file_time_type::clock::now() - std::chrono::hours(24 * 31));
    fs::resize_file(file("view-cut"), 20);
    write_file(file("view-odd"), R"({"volume": 3, "scene": []})");
    KeptViews kept(folder.views());
    EXPECT_FALSE(fs::exists(file("view-old")));
    EXPECT_FALSE(kept.find("view-cut"));
    EXPECT_FALSE(kept.find("view-odd"));
    EXPECT_TRUE(kept.find("view-new"));
    EXPECT_EQ(kept.volumes().size(), 1u);
    kept.forget_below("/nowhere");
    EXPECT_TRUE(kept.find("view-new"));
}

TEST(ServerKept, WhereNothingIsKeptNothingIsWritten) {
    KeptViews none{fs::path()};
    none.note(view("view-one", "scan.nrrd", 1));
    EXPECT_FALSE(none.find("view-one"));
    EXPECT_TRUE(none.volumes().empty());
}

/// A page that is there before the volume is read gets its state with the volume, as one that comes later does.
TEST(ServerKept, IsShownAgainHoweverLongTheVolumeIsRead) {
    const Folder cache;
    setenv("XDG_CACHE_HOME", cache.path.c_str(), 1);
    {
        const Json scene{{"volume", {{"file", "sample:shells:256"}}}, {"mode", "mip"}};
        KeptViews(cache.views()).note({"view-one", "sample:shells:256", scene, {{"undo", {{"design", {1, 2}}}}}, 0});
        const Server server("sample:shells:256", true);
        for (int time = 0; time < 2; ++time) {
            Page page = server.page("view-one", time ? "&take=1" : "");
            const auto told = page.find(
                [](const Message& m) { return !m.is_frame && m.json.contains("scene") && !m.json["scene"].is_null(); });
            ASSERT_TRUE(told);
            EXPECT_EQ(told->json["type"], time ? "hello" : "opened") << "the first is there before the volume";
            EXPECT_EQ(told->json["scene"]["mode"], "mip") << told->json;
            EXPECT_EQ(told->json["undo"]["undo"]["design"].size(), 2u);
        }
    }
    unsetenv("XDG_CACHE_HOME");
}

// What servers sent and a folder keeps: fetched once, asked for each time, never trusted beyond its checksum.
#include <atomic>
#include <fstream>

#include "http_store.h"

using namespace chiaro;
using namespace volume_files;

namespace {

/// A folder in which what servers sent is kept while this lives.
struct Cache {
    const Folder folder;
    explicit Cache(const std::string& size = "64M") {
        setenv("CHIARO_HTTP_CACHE", (folder / "kept/here").c_str(), 1);
        setenv("CHIARO_HTTP_CACHE_SIZE", size.c_str(), 1);
    }
    ~Cache() { unsetenv("CHIARO_HTTP_CACHE"), unsetenv("CHIARO_HTTP_CACHE_SIZE"); }

    std::vector<fs::path> files() const {
        std::vector<fs::path> all;
        if (!fs::exists(folder / "kept/here")) return all;
        for (const auto& entry : fs::directory_iterator(folder / "kept/here")) all.push_back(entry.path());
        return all;
    }
    std::uintmax_t bytes() const {
        std::uintmax_t sum = 0;
        for (const auto& path : files()) sum += fs::file_size(path);
        return sum;
    }
};

const auto all_voxels = ramp<std::uint16_t>(store_voxels);

}  // namespace

TEST(HttpCache, WhatIsKeptIsNotFetchedAgain) {
    for (const bool has_shards : {false, true}) {
        const Cache cache;
        const HttpServer server(handler_of(store(layout(has_shards))));
        EXPECT_EQ(voxels_of<std::uint16_t>(read_from(server.url("a.zarr"))), all_voxels);
        const auto first = server.bytes();
        const auto asked = server.requests().size();
        EXPECT_GT(cache.files().size(), has_shards ? 4u : 30u);
        EXPECT_EQ(voxels_of<std::uint16_t>(read_from(server.url("a.zarr"))), all_voxels);
        const auto source = open_brick_source(server.url("a.zarr"), named);
        Progress progress;
        EXPECT_EQ(voxels_of<std::uint16_t>(read_level(*source, 0, progress)), all_voxels);
        const auto of_files_that_are_not_there = [&] {
            std::uint64_t sum = 0;
            for (const auto& request : server.requests()) sum += request.headers.contains("if-none-match") ? 0 : 4;
            return sum;
        };
        EXPECT_LT(server.bytes() - first, of_files_that_are_not_there() + 100) << "bytes of chunks came again";
        EXPECT_GT(server.requests().size(), asked) << "the server is asked whether they are the same";
        const auto mode = fs::status(cache.files()[0]).permissions() & fs::perms::all;
        EXPECT_EQ(mode, fs::perms::owner_read | fs::perms::owner_write);
        EXPECT_EQ(fs::status(cache.folder / "kept/here").permissions() & fs::perms::all, fs::perms::owner_all);
    }
}

TEST(HttpCache, DecodersBesideEachOtherAskOnce) {
    const Cache cache;
    const HttpServer server(handler_of(store(layout(false))));
    for (int again = 1; again <= 2; ++again) {
        const auto source = open_brick_source(server.url("a.zarr"), named);
        Progress progress;
        EXPECT_EQ(voxels_of<std::uint16_t>(read_level(*source, 0, progress)), all_voxels);
        std::map<std::string, int> times;
        for (const auto& request : server.requests()) ++times[request.path];
        for (const auto& [path, count] : times) EXPECT_EQ(count, again) << path;
    }
}

TEST(HttpCache, WhatChangedOnTheServerIsFetched) {
    const Cache cache;
    auto other = layout(false);
    other.codec = "";
    const auto changed = store(other);
    std::atomic<bool> is_changed{false};
    const HttpServer server([&, files = store(layout(false))](const HttpRequest& request) {
        const auto& now = is_changed ? changed : files;
        const auto found = now.find(request.path);
        if (found == now.end()) return HttpAnswer{.status = 404};
        return answer_with(found->second, request, is_changed ? "\"two\"" : "\"one\"");
    });
    EXPECT_EQ(voxels_of<std::uint16_t>(read_from(server.url("a.zarr"))), all_voxels);
    const auto kept = cache.files().size();
    is_changed = true;
    EXPECT_EQ(voxels_of<std::uint16_t>(read_from(server.url("a.zarr"))), all_voxels);
    EXPECT_EQ(cache.files().size(), kept) << "in the place of what was there";
    const auto before = server.bytes();
    EXPECT_EQ(voxels_of<std::uint16_t>(read_from(server.url("a.zarr"))), all_voxels);
    EXPECT_LT(server.bytes() - before, 1000u);
}

TEST(HttpCache, DamagedFilesAreFetchedAgain) {
    const Cache cache;
    const HttpServer server(handler_of(store(layout(false))));
    read_from(server.url("a.zarr"));
    std::size_t i = 0;
    for (const auto& path : cache.files()) {
        std::string bytes = content_of(path);
        switch (i++ % 4) {
            case 0:
                bytes[bytes.size() / 2] ^= 4;
                break;
            case 1:
                bytes.resize(bytes.size() / 3);
                break;
            case 2:
                bytes.clear();
                break;
            default:
                bytes += "more";
        }
        std::ofstream(path, std::ios::binary) << bytes;
    }
    const auto before = server.bytes();
    EXPECT_EQ(voxels_of<std::uint16_t>(read_from(server.url("a.zarr"))), all_voxels);
    EXPECT_GT(server.bytes() - before, 10000u);
    const auto again = server.bytes();
    EXPECT_EQ(voxels_of<std::uint16_t>(read_from(server.url("a.zarr"))), all_voxels);
    EXPECT_LT(server.bytes() - again, 1000u) << "they are whole again";
}

TEST(HttpCache, WhatWasNotUsedForLongGoesWhereThereIsNoRoom) {
    const Cache cache("1M");
    ZarrLayout plain = layout(false);
    plain.codec = "";  // 512 KiB in all
    const HttpServer server([files = store(plain, "/")](const HttpRequest& request) {
        const auto found = files.find(request.path.substr(request.path.find('/', 1)));
        return found == files.end() ? HttpAnswer{.status = 404} : answer_with(found->second, request);
    });
    const auto show = [&](const std::string& name) {
        EXPECT_EQ(voxels_of<std::uint16_t>(read_from(server.url(name))), all_voxels);
        EXPECT_LE(cache.bytes(), 1u << 20);
    };
    const auto kept_of = [&](const std::string& name) {
        return std::ranges::count_if(cache.files(), [&](const fs::path& path) {
            return content_of(path).find("\n" + server.url(name) + " ") != std::string::npos;
        });
    };
    const auto an_hour_passes = [&] {
        for (const auto& path : cache.files())
            fs::last_write_time(path, fs::last_write_time(path) - std::chrono::hours(1));
    };
    show("a");
    const auto all = kept_of("a");
    EXPECT_GT(all, 30);
    const fs::path mine = cache.folder / "kept/here/mine.txt";
    std::ofstream(mine) << "not the cache's";
    an_hour_passes();
    show("b");
    EXPECT_EQ(kept_of("b"), all);
    EXPECT_GT(kept_of("a"), 0);
    EXPECT_LT(kept_of("a"), all);
    an_hour_passes();
    show("b");  // and is used later than what is left of a
    show("c");
    EXPECT_EQ(kept_of("c"), all);
    EXPECT_EQ(kept_of("a"), 0);
    EXPECT_GT(kept_of("b"), all / 2);
    EXPECT_TRUE(fs::exists(mine));
}

TEST(HttpCache, NothingIsKeptThatNoStrongTagStandsFor) {
    const Cache cache;
    for (const std::string tag : {"", "ETag: W/\"1\"", "ETag: one", "ETag: \"a b\"", "ETag: \"\"x"}) {
        EXPECT_EQ(refusal(false,
                          [&](const HttpRequest&, HttpAnswer& answer) {
                              without(answer.headers, "ETag");
                              if (!tag.empty()) answer.headers.push_back(tag);
                          }),
                  "nothing was wrong");
        EXPECT_TRUE(cache.files().empty()) << tag;
    }
    expect_in("redirects to nowhere", refusal(false, [](const HttpRequest& request, HttpAnswer& answer) {
                  if (is_chunk(request)) answer = {.status = 304};  // of what it was not asked for
              }));
}

TEST(HttpCache, FoldersThatCannotBeAreToldAndNoneIsMadeUnasked) {
    const HttpServer server(handler_of(store(layout(false))));
    {
        const Cache cache("little");
        EXPECT_THROW(read_from(server.url("a.zarr")), Error);
        setenv("CHIARO_HTTP_CACHE_SIZE", "1M", 1);
        setenv("CHIARO_HTTP_CACHE", cache.folder.write("file", "in the way").c_str(), 1);
        try {
            read_from(server.url("a.zarr"));
            ADD_FAILURE();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::output);
            expect_in("is no folder", error.what());
        }
        EXPECT_TRUE(server.requests().empty());
    }
    read_from(server.url("a.zarr"));
    for (const auto& request : server.requests()) EXPECT_FALSE(request.headers.contains("if-none-match"));
}

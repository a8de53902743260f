// Zarr stores on a server: the same voxels as in a folder, few bytes for a first picture, and a sentence for whatever a
// server does wrong.
#include <chiaro/session.h>

#include <cmath>

#include "http_store.h"
#include "tool_case.h"

using namespace chiaro;
using namespace volume_files;

TEST(Http, StoresHoldWhatTheyHoldInAFolder) {
    for (ZarrLayout one : {layout(false), layout(true)})
        for (const int version : {2, 3}) {
            if (version == 2 && !one.shard.empty()) one.shard = {}, one.chunk = {64, 64, 1};
            one.version = version, one.index_is_first = version == 2;
            const HttpServer server(handler_of(store(one)));
            const Volume volume = read_from(server.url("a.zarr/"));
            EXPECT_EQ(voxels_of<std::uint16_t>(volume), ramp<std::uint16_t>(store_voxels));
            EXPECT_EQ(volume.dimensions, (std::array{64, 64, 64}));
            EXPECT_LE(server.most_at_once(), 8);
        }
}

TEST(Http, ByBricksManyAreAskedForAtATimeAndEachOnce) {
    ZarrLayout many = layout(false);
    many.chunk = {16, 16, 16};
    const HttpServer server([whole = handler_of(store(many))](const HttpRequest& request) {
        HttpAnswer answer = whole(request);
        answer.late_ms = 50;
        return answer;
    });
    const auto source = open_brick_source(server.url("a.zarr"), named);
    ASSERT_TRUE(source);
    EXPECT_TRUE(source->is_far());
    Progress progress;
    const Volume volume = read_level(*source, 0, progress);
    EXPECT_EQ(voxels_of<std::uint16_t>(volume), ramp<std::uint16_t>(store_voxels));
    EXPECT_GT(server.most_at_once(), 1);
    EXPECT_LE(server.most_at_once(), 8);
    std::map<std::string, int> times;
    for (const auto& request : server.requests()) ++times[request.path];
    for (const auto& [path, count] : times) EXPECT_EQ(count, 1) << path;
}

TEST(Http, ImagesAndLabelsArePickedByTheirPath) {
    auto files = store(layout(false), "/a.zarr/0/");
    files.merge(store(layout(true), "/a.zarr/labels/cells/0/"));
    const std::string levels =
        R"("multiscales": [{"axes": [{"name": "z", "type": "space"}, {"name": "y", "type": "space"},
           {"name": "x", "type": "space"}], "datasets": [{"path": "0", "coordinateTransformations": [{"type": "scale",
           "scale": [2, 1, 1]}]}]}])";
    const auto group = [](const std::string& what) {
        return R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome": {)" + what + "}}}";
    };
    files["/a.zarr/zarr.json"] = files["/a.zarr/labels/cells/zarr.json"] = group(levels);
    files["/a.zarr/labels/zarr.json"] = group(R"("labels": ["cells"])");
    const HttpServer server(handler_of(files));
    const Volume image = read_from(server.url("a.zarr"));
    EXPECT_EQ(image.geometry.spacing_mm, (Vec3{1, 1, 2}));
    EXPECT_TRUE(std::ranges::any_of(image.notes, [](auto& n) { return n.find("labels/cells") != n.npos; }));
    EXPECT_EQ(read_from(server.url("a.zarr#labels/cells")).key_values.at("path"), "labels/cells");
    EXPECT_EQ(read_from(server.url("a.zarr#0")).dimensions, (std::array{64, 64, 64}));
    EXPECT_THROW(read_from(server.url("a.zarr#1")), Error);
}

TEST(Http, PrivateAddressesAreThoseThatWereNamed) {
    const auto nothing = [](const HttpRequest&, HttpAnswer&) {};
    expect_in("private net", refusal(false, nothing, {}));
    const HttpServer other(handler_of(store(layout(false))));
    expect_in("private net", refusal(false, [&](const HttpRequest& request, HttpAnswer& answer) {
                  if (is_chunk(request))
                      answer = {.status = 302, .headers = {"Location: " + other.url("a.zarr/c/0/0/0")}};
              }));
    EXPECT_TRUE(other.requests().empty());
    expect_in("password", [] {
        try {
            read_from("http://a:b@127.0.0.1/a.zarr");
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    }());
}

TEST(Http, FiveRedirectsAreFollowed) {
    const auto through = [](int most) {
        return [most](const HttpRequest& request, HttpAnswer& answer) {
            const auto dots = std::ranges::count(request.path, '!');
            if (!is_chunk(request)) return;
            if (dots < most) answer = {.status = 307, .headers = {"Location: " + request.path + "!"}};
            if (dots == most)
                answer = answer_with(store(layout(false)).at(request.path.substr(0, request.path.find('!'))), request);
        };
    };
    EXPECT_EQ(refusal(false, through(5)), "nothing was wrong");
    expect_in("redirects more than 5", refusal(false, through(6)));
    expect_in("neither http nor https", refusal(false, [](const HttpRequest& request, HttpAnswer& answer) {
                  if (is_chunk(request)) answer = {.status = 301, .headers = {"Location: file:///etc/passwd"}};
              }));
}

TEST(Http, WhatAServerDoesWrongIsASentence) {
    const auto chunks = [](auto change) {
        return [change](const HttpRequest& request, HttpAnswer& answer) {
            if (is_chunk(request)) change(request, answer);
        };
    };
    expect_in("more than the", refusal(false, chunks([](auto&, HttpAnswer& a) { a.body.resize(1 << 20); })));
    expect_in("whole files where a part", refusal(true, chunks([](auto& request, HttpAnswer& a) {
                                                      a = handler_of(store(layout(true)))({request.path, {}});
                                                  })));
    expect_in("other bytes than", refusal(true, chunks([](auto&, HttpAnswer& a) {
                                              without(a.headers, "Content-Range"),
                                                  a.headers.push_back("Content-Range: bytes 3-9/100");
                                          })));
    expect_in("other bytes than",
              refusal(true, chunks([](auto&, HttpAnswer& a) { without(a.headers, "Content-Range"); })));
    expect_in("changed", refusal(true, chunks([n = std::make_shared<std::atomic<int>>()](auto&, HttpAnswer& a) {
                                     without(a.headers, "ETag"), a.headers.push_back(fmt::format("ETag: \"{}\"", ++*n));
                                 })));
    expect_in("packs what it sends",
              refusal(false, chunks([](auto&, HttpAnswer& a) { a.headers.push_back("Content-Encoding: gzip"); })));
    expect_in("of another size", refusal(false, chunks([](auto&, HttpAnswer& a) {
                                             a.body = deflated(std::string(200 << 10, '\0'), 31);  // a bomb
                                         })));
    expect_in("answers 500", refusal(false, chunks([](auto&, HttpAnswer& a) { a = {.status = 500}; })));
    expect_in("forbids", refusal(false, chunks([](auto&, HttpAnswer& a) { a = {.status = 403}; })));
    expect_in("CHIARO_HTTP_TOKEN", refusal(false, chunks([](auto&, HttpAnswer& a) { a = {.status = 401}; })));
    expect_in("half-way", refusal(false, chunks([](auto&, HttpAnswer& a) { a.cut_at = a.body.size() / 2; })));
    expect_in("does not answer", refusal(false, chunks([](auto&, HttpAnswer& a) { a.is_silent = true; })));
    expect_in("no Zarr metadata", refusal(false, [](auto&, HttpAnswer& a) { a = {.status = 404}; }));
    expect_in("headers without end", refusal(false, chunks([](auto&, HttpAnswer& a) {
                                                 for (int i = 0; i < 100; ++i)
                                                     a.headers.push_back("X-More: " + std::string(1000, 'x'));
                                             })));
}

TEST(Http, AServerThatIsNotThereIsASentence) {
    int port = 0;
    {
        const HttpServer server(handler_of({}));
        port = server.port();
    }
    try {
        read_from(fmt::format("http://127.0.0.1:{}/a.zarr", port));
        ADD_FAILURE();
    } catch (const Error& error) {
        expect_in("cannot be reached", error.what());
    }
}

TEST(Http, WhatFailsForAMomentIsAskedForAgain) {
    const auto failures = std::make_shared<std::atomic<int>>();
    EXPECT_EQ(refusal(false,
                      [failures](const HttpRequest& request, HttpAnswer& answer) {
                          if (!is_chunk(request)) return;
                          const int n = ++*failures;
                          if (n == 1) answer = {.status = 503, .headers = {"Retry-After: 1"}};
                          if (n == 2) answer.cut_at = 10;
                      }),
              "nothing was wrong");
    EXPECT_GE(*failures, 3);
}

TEST(Http, TokenAndHeadersComeFromTheEnvironment) {
    setenv("CHIARO_HTTP_TOKEN", "secret", 1);
    setenv("CHIARO_HTTP_HEADERS", "X-One: 1\nX-Two: 2", 1);
    const HttpServer server(handler_of(store(layout(false))));
    read_from(server.url("a.zarr"));
    unsetenv("CHIARO_HTTP_TOKEN"), unsetenv("CHIARO_HTTP_HEADERS");
    for (const auto& request : server.requests()) {
        EXPECT_EQ(request.headers.at("authorization"), "Bearer secret");
        EXPECT_EQ(request.headers.at("x-two"), "2");
    }
}

namespace {

/// A store of 4096³ voxels of 16 bits and coarser levels, 157 GB, made chunk by chunk as they are asked for: a rough
/// ball.
struct Huge {
    static constexpr int levels = 7, chunk = 64, largest = 4096;
    static constexpr std::size_t chunk_bytes = 2u * chunk * chunk * chunk;

    static HttpAnswer answer(const HttpRequest& request) {
        if (request.path == "/huge.zarr/zarr.json") return {.body = group()};
        for (int level = 0; level < levels; ++level) {
            const std::string folder = fmt::format("/huge.zarr/{}/", level);
            const int n = largest >> level;
            if (request.path == folder + "zarr.json")
                return {.body = zarr_metadata<std::uint16_t>(
                            {.shape = {n, n, n}, .chunk = {chunk, chunk, chunk}, .version = 3, .separator = '/'})};
            int z = 0, y = 0, x = 0;
            if (std::sscanf(request.path.c_str(), (folder + "c/%d/%d/%d").c_str(), &z, &y, &x) == 3)
                return {.body = voxels(n, x * chunk, y * chunk, z * chunk)};
        }
        return {.status = 404};
    }

    static std::string voxels(int n, int x0, int y0, int z0) {
        std::string bytes(chunk_bytes, '\0');
        auto* out = reinterpret_cast<std::uint16_t*>(bytes.data());
        const float scale = 2.F / float(n);
        for (int z = 0; z < chunk; ++z)
            for (int y = 0; y < chunk; ++y)
                for (int x = 0; x < chunk; ++x) {
                    const float px = (float(x0 + x) + .5F) * scale - 1, py = (float(y0 + y) + .5F) * scale - 1,
                                pz = (float(z0 + z) + .5F) * scale - 1;
                    const float inside = .8F - std::sqrt(px * px + py * py + pz * pz);
                    *out++ = std::uint16_t(std::clamp(20000 + 60000 * inside, 0.F, 60000.F)) ^
                             std::uint16_t((x * 7 + y * 5 + z * 3) & 63);
                }
        return bytes;
    }

    static std::string group() {
        std::string sets;
        for (int level = 0; level < levels; ++level) {
            const int scale = 1 << level;
            const double shift = (scale - 1) / 2.;
            sets += fmt::format(R"({}{{"path": "{}", "coordinateTransformations": [{{"type": "scale", "scale":
                                [{}, {}, {}]}}, {{"type": "translation", "translation": [{}, {}, {}]}}]}})",
                                level ? ", " : "", level, scale, scale, scale, shift, shift, shift);
        }
        const std::string axes = R"({"name": "z", "type": "space", "unit": "micrometer"},
            {"name": "y", "type": "space", "unit": "micrometer"}, {"name": "x", "type": "space", "unit": "micrometer"})";
        return R"({"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.5", "multiscales":
               [{"axes": [)" +
               axes + R"(], "datasets": [)" + sets + "]}]}}}";
    }
};

/// Of a store's paths the level; -1: no chunk.
int level_of(const std::string& path) {
    int level = -1;
    return path.find("/c/") != path.npos && std::sscanf(path.c_str(), "/huge.zarr/%d/", &level) == 1 ? level : -1;
}

using HttpTool = ToolTest;

}  // namespace

TEST_F(HttpTool, AHundredGigabytesShowAPictureAfterFewBytes) {
    std::atomic<std::uint64_t> before_first{0};
    std::unique_ptr<HttpServer> server;
    server = std::make_unique<HttpServer>([&](const HttpRequest& request) {
        if (server && !std::filesystem::exists(folder / "first.png")) before_first = server->bytes();
        return Huge::answer(request);
    });
    const Said said =
        tool(fmt::format("render {} --memory 2G --size 512x384 --first-picture first.png "
                         "-o last.png --stats last.json",
                         server->url("huge.zarr")));
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_LT(before_first, 50e6);
    const auto stats = json("last.json");
    const int level = stats["paging"]["level"], light = stats["paging"]["light_level"];
    EXPECT_LE(1 << level, 16) << said.err;
    std::map<std::string, int> times;
    for (const auto& request : server->requests()) ++times[request.path];
    std::uint64_t seen = 0;
    for (const auto& [path, count] : times)
        if (level_of(path) == level) {
            seen += Huge::chunk_bytes;
            EXPECT_EQ(count, 1) << path;
        }
    EXPECT_LT(level, light);
    EXPECT_LE(server->bytes(), 3 * seen);
    EXPECT_LE(server->most_at_once(), 8);
    std::printf("%.0f MB before the first picture, %.0f MB in all; %.0f MB of chunks seen at level %d\n",
                double(before_first) / 1e6, double(server->bytes()) / 1e6, double(seen) / 1e6, level);
}

// 50 ms away, by 100 Mbit/s: few questions follow one another before there is a picture.
TEST_F(HttpTool, ASlowLinkShowsAPictureAfterFewBytes) {
    const auto began = std::chrono::steady_clock::now();
    const auto since = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(); };
    std::atomic<std::uint64_t> before_first{0};
    std::atomic<double> first_after{0};
    std::unique_ptr<HttpServer> server;
    server = std::make_unique<HttpServer>(
        [&](const HttpRequest& request) {
            if (server && !std::filesystem::exists(folder / "first.png"))
                before_first = server->bytes(), first_after = since();
            return Huge::answer(request);
        },
        HttpLink{.round_trip_ms = 50, .bytes_per_second = 12.5e6});
    const Said said =
        tool(fmt::format("render {} --memory 2G --size 256x192 --first-picture first.png -o last.png --stats last.json",
                         server->url("huge.zarr")));
    ASSERT_EQ(said.code, 0) << said.err;
    EXPECT_LT(before_first, 50e6);
    EXPECT_LE(1 << json("last.json")["paging"]["level"].get<int>(), 32) << said.err;
    EXPECT_TRUE(json("last.json")["paging"]["faults"].empty());
    std::printf("%.1f MB and %.2f s before the first picture, %.0f MB and %.1f s in all\n", double(before_first) / 1e6,
                double(first_after), double(server->bytes()) / 1e6, since());
}

TEST_F(HttpTool, InfoTellsAndMisuseIsToldInASentence) {
    const HttpServer server([](const HttpRequest& request) { return Huge::answer(request); });
    const Said info = tool("info --json --memory 2G " + server.url("huge.zarr"));
    ASSERT_EQ(info.code, 0) << info.err;
    const auto told = nlohmann::json::parse(info.out);
    EXPECT_EQ(told["statistics"], "sampled");
    EXPECT_EQ(told["dimensions"], (std::array{4096, 4096, 4096}));
    EXPECT_LT(server.bytes(), 50e6);
    for (const std::string bad : {"http://", "http://127.0.0.1:1/a.zarr", "https://127.0.0.1:1/a.zarr?b=1"}) {
        const Said said = tool("info '" + bad + "'");
        EXPECT_EQ(said.code, 3) << bad;
        EXPECT_EQ(std::ranges::count(said.err, '\n'), 1) << said.err;
    }
    write("scene.json", R"({"chiaro": 1, "volume": {"file": ")" + server.url("huge.zarr") + R"("}})");
    const Said scene = tool("render --scene scene.json -o no.png");
    EXPECT_EQ(scene.code, 3) << scene.err;
    EXPECT_NE(scene.err.find("private net"), scene.err.npos) << scene.err;
}

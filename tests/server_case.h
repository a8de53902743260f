// A server of its own for each test, and what pages say to it.
#pragma once
#include <chiaro/chiaro.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <thread>

#include "server/serve.h"
#include "web_client.h"

namespace chiaro::testing {

namespace fs = std::filesystem;

inline constexpr const char* test_token = "00112233445566778899aabbccddeeff";

/// A server of a small ball, in a folder of its own.
class Server {
public:
    explicit Server(const std::string& volume = "sample:ball:32", bool keep_views = false,
                    const PagingSettings& paging = {}) {
        setenv("CHIARO_VIEW_TOKEN", test_token, 1);
        std::string name = (fs::temp_directory_path() / "chiaro-server-test-XXXXXX").string();
        folder = mkdtemp(name.data());
        server::ViewerOptions options;
        options.folders = {folder};
        options.port = 0;
        options.device = Device::cpu(2);
        options.keep_views = keep_views, options.paging = paging;
        if (!volume.empty()) options.scene = scene_of_volume(volume);
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

inline Json state(int n, const Json& scene, int width = 64, int height = 48, bool moving = false) {
    return {{"type", "state"}, {"n", n}, {"scene", scene}, {"canvas", {width, height}}, {"moving", moving}};
}

inline std::string file_bytes(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_file(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

inline int status_of_socket(int port, const std::string& token, const std::string& view, const std::string& fields) {
    const std::string upgrade =
        "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
        "dGhlIHNhbXBsZSBub25jZQ==\r\n";
    return http(port, "GET", "/socket?token=" + token + "&view=" + view, upgrade + fields).status;
}

inline std::size_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::size_t pages = 0, resident = 0;
    statm >> pages >> resident;
    return resident * std::size_t(sysconf(_SC_PAGESIZE));
}

}  // namespace chiaro::testing

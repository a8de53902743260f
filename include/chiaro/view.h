// The viewer's server, to embed: what `chiaro view` is, in a program of one's own.
#pragma once
#include <chiaro/device.h>
#include <chiaro/export.h>
#include <chiaro/scene.h>
#include <chiaro/session.h>
#include <chiaro/volume.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace chiaro {

struct ViewSettings {
    Scene scene;  ///< what is shown first
    /// Its volume, where that is in memory: of the name `scene.volume`. The voxels stay as they are. None: it is read.
    std::shared_ptr<const Volume> volume;
    /// Its volume, where it is read by bricks, or whole where it fits: of the name `scene.volume`. Not both.
    std::shared_ptr<const BrickSource> source;
    PagingSettings paging;                       ///< how volumes that do not fit are read
    std::vector<std::filesystem::path> folders;  ///< whose files pages may open; none: the current one
    std::string host = "127.0.0.1";
    int port = 0;                 ///< 0: any that is free
    std::string base_path = "/";  ///< under which a proxy has the page, "/user/ann/proxy/8480/"
    /// Origins that may frame the page, and that it may have behind a proxy, "https://hub.org"; none: no page may.
    std::vector<std::string> embed_from;
    Device device;
    /// Hears of each state of a page, in a thread of the server's. May not throw, nor stop the server.
    std::function<void(const Scene&)> changed;
};

/// Serves from its construction on, in threads of its own, until it is stopped or goes. Part of the shared library.
class ViewServer {
public:
    /// Throws Error{usage} for an address, origin or path that is none, Error{output} where it cannot be had.
    CHIARO_EXPORT explicit ViewServer(const ViewSettings& settings);
    CHIARO_EXPORT ~ViewServer();

    CHIARO_EXPORT int port() const;
    /// The address on this machine, with a token that is good as long as the server lives: not for files.
    CHIARO_EXPORT std::string url() const;
    /// Path and query of the page, good for one visit within 60 s: to be put behind the address that a browser knows.
    CHIARO_EXPORT std::string path_of_one_visit();
    /// The newest state of a page; what was shown first, or put, before there is one.
    CHIARO_EXPORT Scene scene() const;
    /// Shows it on all pages, now and to come. The volume stays.
    CHIARO_EXPORT void put(const Scene& scene);
    CHIARO_EXPORT void stop();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace chiaro

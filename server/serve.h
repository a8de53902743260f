// `chiaro view`: a page that explores volumes, served.
#pragma once
#include <chiaro/progress.h>
#include <chiaro/scene.h>
#include <chiaro/session.h>
#include <chiaro/volume.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace chiaro::server {

inline constexpr std::uint64_t default_max_upload = std::uint64_t(4) << 30;

struct ViewerOptions {
    std::optional<Scene> scene;                  ///< what to show first
    std::vector<std::filesystem::path> folders;  ///< whose files pages may open, at least one
    std::filesystem::path data;                  ///< where volumes of scenes are looked up too
    std::string host = "127.0.0.1";
    std::optional<int> port;      ///< none: the usual one, or another that is free; 0: any
    std::string base_path = "/";  ///< under which a proxy has the page: "/user/ann/proxy/8480/"
    /// Origins that may frame the page, and that it may have behind a proxy: "https://hub.org".
    std::vector<std::string> embed_from{};
    std::string token{};  ///< "": the user's own at this port
    /// What the first scene shows, where that is in memory; its voxels stay as they are.
    std::shared_ptr<const Volume> volume{};
    std::shared_ptr<const BrickSource> source{};    ///< the same, where it is read by bricks
    std::function<void(const Scene&)> changed{};    ///< hears of each state of a page; from another thread
    bool keep_views = false;                        ///< on disk, for a server that is killed
    std::uint64_t max_upload = default_max_upload;  ///< bytes of a volume that a page sends
    Device device;
    PagingSettings paging{};                   ///< how volumes that do not fit are read
    Progress::Report report = {};              ///< hears of reading the first volume
    std::function<void(double)> read_in = {};  ///< is told the seconds it took ...
    /// ... or why it cannot be read, which each page is told, too; all three from another thread.
    std::function<void(const std::string& sentence)> unreadable = {};
};

/// The server behind server/PROTOCOL.md. Listens from its construction on. Throws Error{usage, output}.
class Viewer {
public:
    static constexpr int default_port = 8480;

    explicit Viewer(const ViewerOptions& options);
    ~Viewer();
    int port() const;
    const std::string& token() const;
    std::string url() const;  ///< with the token
    /// The path of the page, with a key that is good for one visit within 60 seconds.
    std::string path_of_one_visit();
    /// What is shown from now on, on every page that is open, and on pages to come. Of the first scene's volume.
    void put(const Scene& scene);
    /// Serves until `stop`, or SIGINT or SIGTERM where `signals`.
    void run(bool signals);
    void stop();  ///< from any thread

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace chiaro::server

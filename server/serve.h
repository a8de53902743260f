// `chiaro view`: a page that explores volumes, served.
#pragma once
#include <chiaro/progress.h>
#include <chiaro/scene.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace chiaro::server {

struct ViewerOptions {
    std::optional<Scene> scene;                  ///< what to show first
    std::vector<std::filesystem::path> folders;  ///< whose files pages may open, at least one
    std::filesystem::path data;                  ///< where volumes of scenes are looked up too
    std::string host = "127.0.0.1";
    std::optional<int> port;  ///< none: the usual one, or another that is free; 0: any
    Device device;
    Progress::Report report = {};              ///< hears of reading the first volume
    std::function<void(double)> read_in = {};  ///< is told the seconds it took; both from another thread
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
    /// Serves until `stop`, or SIGINT or SIGTERM where `signals`.
    void run(bool signals);
    void stop();  ///< from any thread

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace chiaro::server

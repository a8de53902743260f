#include <chiaro/view.h>

#include <mutex>
#include <thread>

#include "serve.h"
#include "token.h"

namespace chiaro {

struct ViewServer::State {
    explicit State(const ViewSettings& settings) : scene(settings.scene), viewer(options_of(settings)) {
        serving = std::thread([this] { viewer.run(false); });
    }
    ~State() {
        viewer.stop();
        if (serving.joinable()) serving.join();
    }

    server::ViewerOptions options_of(const ViewSettings& settings) {
        server::ViewerOptions options;
        options.scene = settings.scene;
        options.volume = settings.volume, options.source = settings.source, options.paging = settings.paging;
        options.folders = settings.folders;
        if (options.folders.empty()) options.folders = {std::filesystem::current_path()};
        options.host = settings.host, options.port = settings.port;
        options.base_path = settings.base_path, options.embed_from = settings.embed_from;
        options.token = server::random_key();
        options.device = settings.device;
        options.changed = [this, hear = settings.changed](const Scene& newest) {
            {
                const std::lock_guard lock(mutex);
                scene = newest;
            }
            if (hear) hear(newest);
        };
        return options;
    }

    mutable std::mutex mutex;
    Scene scene;
    server::Viewer viewer;
    std::thread serving;
};

ViewServer::ViewServer(const ViewSettings& settings) : state_(std::make_unique<State>(settings)) {}
ViewServer::~ViewServer() = default;
int ViewServer::port() const { return state_->viewer.port(); }
std::string ViewServer::url() const { return state_->viewer.url(); }
std::string ViewServer::path_of_one_visit() { return state_->viewer.path_of_one_visit(); }
Scene ViewServer::scene() const {
    const std::lock_guard lock(state_->mutex);
    return state_->scene;
}
void ViewServer::put(const Scene& scene) {
    {
        const std::lock_guard lock(state_->mutex);
        state_->scene = scene;
    }
    state_->viewer.put(scene);
}
void ViewServer::stop() {
    state_->viewer.stop();
    if (state_->serving.joinable()) state_->serving.join();
}

}  // namespace chiaro

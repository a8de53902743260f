// A view's pictures: always of the newest state, from the quickest to the best.
#pragma once
#include <chiaro/pick.h>
#include <chiaro/session.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "json.h"
#include "pace.h"
#include "volumes.h"

namespace chiaro::server {

/// What a page wants to see.
struct Wish {
    std::int64_t n = 0;
    Scene scene;  ///< its size is the canvas's
    bool moving = false, preview = false;
    std::vector<std::string> notes;  ///< to be told with its frames
    int connection = 0;              ///< which of the view's connections wished it
    std::chrono::steady_clock::time_point arrived = std::chrono::steady_clock::now();
};

/// What the last frame showed.
struct Seen {
    std::int64_t n;
    Medium medium;
    Camera camera;
    RaySettings rays;
    int width, height;
};

class Painter {
public:
    /// Both may be called from the painter's thread until it is destroyed.
    struct Outlet {
        std::function<void(int connection, std::string frame)> frame;
        std::function<void(int connection, const Json& message)> tell;
    };

    explicit Painter(Outlet outlet) : outlet_(std::move(outlet)) {}
    ~Painter();

    /// The volume of what is wished from now on; none frees what was made from it.
    void show(std::shared_ptr<const Loaded> loaded);
    /// Takes the place of every earlier wish; work that is only for these is given up.
    void wish(Wish wish);
    std::optional<Seen> seen() const;

private:
    using Clock = std::chrono::steady_clock;

    void run();
    void change_volume(std::unique_lock<std::mutex>& lock);
    void paint(const Wish& wish);
    void draft(const Wish& wish);
    void draft_with_light(const Wish& wish, const Scene& small);
    bool is_light_due(const Scene& scene) const;
    void check_light_fits(const Scene& scene) const;
    bool comes_to_rest(const Wish& wish);
    void refine(const Wish& wish, Progress& progress);
    void refine_traced(const Wish& wish, Progress& progress);
    void refine_cast(const Wish& wish, Progress& progress);
    void learn_light();
    void note_seen(const Wish& wish, const Scene& scene);
    void send(const Wish& wish, const Image& image, const char* stage, int samples, bool is_coarse = false);
    Progress::Report report_for(const Wish& wish);

    Outlet outlet_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Wish> newest_;
    std::shared_ptr<const Loaded> shown_;
    bool volume_changed_ = false, ending_ = false;
    std::shared_ptr<Progress> steady_, refining_;  ///< of drafts; of what a newer wish stops
    std::optional<Seen> seen_;
    std::thread thread_;

    // The thread's own.
    std::optional<Session> session_;
    Pace pace_;
    double light_seconds_ = 1e9;  ///< what light took last
    Clock::time_point light_found_, last_draft_;
    double draft_interval_ = 0;
    bool is_whole_ = false;  ///< the last draft had the canvas's size and no better light to come
};

}  // namespace chiaro::server

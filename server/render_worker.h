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

#include "adaptive_resolution.h"
#include "json.h"
#include "link_pace.h"
#include "moments.h"
#include "volumes.h"

namespace chiaro::server {

/// What a page wants to see.
struct FrameRequest {
    std::int64_t n = 0;
    Scene scene;    ///< its size is the canvas's
    int next = -1;  ///< the moment that will be asked for then, to be made ready
    bool moving = false, preview = false;
    std::vector<std::string> notes;  ///< to be told with its frames
    int connection = 0;              ///< which of the view's connections requested it
    std::chrono::steady_clock::time_point arrived = std::chrono::steady_clock::now();
};

/// What the last frame showed.
struct LastFrame {
    std::int64_t n;
    Medium medium;
    Geometry finest;  ///< in whose voxels places are told
    Camera camera;
    RaySettings rays;
    int width, height;
};

inline constexpr int still_quality = 92;  ///< of a JPEG of what is at rest

double seconds_since(std::chrono::steady_clock::time_point start);
Scene with_samples(Scene scene, int samples);

class RenderWorker {
public:
    /// Both may be called from the render worker's thread until it is destroyed.
    struct FrameCallbacks {
        std::function<void(int connection, std::string frame)> frame;
        std::function<void(int connection, const Json& message)> tell;
        std::function<LinkState()> link = [] { return LinkState(); };  ///< the way to the page
    };

    explicit RenderWorker(FrameCallbacks callbacks) : callbacks_(std::move(callbacks)) {}
    ~RenderWorker();

    /// The volume of what is requested from now on; none frees what was made from it.
    void show(std::shared_ptr<const Loaded> loaded);
    /// Takes the place of every earlier request; work that is only for these is given up.
    void request(FrameRequest wanted);
    std::optional<LastFrame> last_frame() const;
    /// Another session of what is shown, where that is this moment of this volume.
    std::optional<Session> share(const Loaded& loaded, int moment) const;
    /// Of whichever moment is shown.
    Session share_shown(const Loaded& loaded) const;
    /// The way to the page may have room again.
    void look_at_link();

private:
    using Clock = std::chrono::steady_clock;

    void run();
    void change_volume(std::unique_lock<std::mutex>& lock);
    void render_frame(FrameRequest wanted);
    bool change_moment(FrameRequest& wanted);
    bool awaits_light() const { return loaded_->moments() > 1 && !has_own_light_; }
    void preview(const FrameRequest& wanted);
    void preview_with_light(const FrameRequest& wanted, const Scene& small, Progress& progress);
    Scene as_draft(Scene scene) const;
    bool is_light_due(const Scene& scene) const;
    void check_light_fits(const Scene& scene) const;
    bool comes_to_rest(const FrameRequest& wanted);
    void refine(const FrameRequest& wanted, Progress& progress);
    void refine_traced(const FrameRequest& wanted, Progress& progress);
    void refine_cast(const FrameRequest& wanted, Progress& progress);
    void learn_light();
    void note_frame(const FrameRequest& wanted, const Scene& scene);
    double too_early(const FrameRequest& wanted) const;
    /// Answers the bytes of the encoded picture.
    std::size_t send(const FrameRequest& wanted, const Image& image, const char* stage, int samples,
                     bool is_coarse = false);
    Progress::Report report_for(const FrameRequest& wanted);

    FrameCallbacks callbacks_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<FrameRequest> newest_;
    std::shared_ptr<const Loaded> shown_;
    bool volume_changed_ = false, ending_ = false, link_moved_ = false;
    std::shared_ptr<Progress> steady_, refining_;  ///< of previews; of what a newer request stops
    std::optional<LastFrame> last_frame_;
    std::optional<Session> voxels_;  ///< of the moment that is shown, beside the first
    int moment_ = 0;                 ///< written by the thread alone
    std::thread thread_;

    // The thread's own.
    std::optional<Session> session_;
    std::shared_ptr<const Loaded> loaded_;  ///< that it is of
    NextMoment next_;
    bool has_own_light_ = false;  ///< found since the moment is shown
    AdaptiveResolution resolution_;
    DraftSize draft_{0, 0, 70};   ///< what the last preview was drawn at
    double light_seconds_ = 1e9;  ///< what light took last
    Clock::time_point light_found_, last_preview_;
    double preview_interval_ = 0;
    bool is_refining_ = false;
    bool is_whole_ = false;  ///< the last preview had the canvas's size and no better light to come
};

}  // namespace chiaro::server

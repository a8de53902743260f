#include "render_worker.h"

#include <chiaro/text.h>

#include <algorithm>
#include <cmath>

#include "jpeg.h"
#include "memory_budget.h"

namespace chiaro::server {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

// The limits below are seconds as a user feels them, chosen by eye as far as history shows; scripts/latency measures
// what they lead to.
constexpr auto rest = milliseconds(60);  // without a newer request: then the image is refined
constexpr int still_far_quality = 75;
// Until a slow way is this free, a picture that a better one follows is not sent.
constexpr double nearly_free = 0.1;
// Light that is quicker than this is found while something moves, for an eighth of the time at most.
constexpr double quick_light = 0.15, light_share = 8, instant_light = 0.04;
// A picture of the whole size that takes no longer needs no smaller one before it.
constexpr double at_once = 0.06;

Json json_of(const std::vector<Stage>& stages) {
    Json list = Json::array();
    for (const Stage& stage : stages) list.push_back({{"name", stage.name}, {"seconds", stage.seconds}});
    return list;
}

/// Light that is none, or is found for each picture.
bool holds_no_light(const Scene& scene) {
    return scene.illumination.method == Method::none || is_path_traced(scene.illumination);
}

}  // namespace

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Scene with_samples(Scene scene, int samples) {
    scene.sampling.samples_per_pixel = samples;
    if (samples == 1) scene.camera.aperture_mm = 0;  // a lens takes many rays: what comes first is sharp
    return scene;
}

RenderWorker::~RenderWorker() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        if (steady_) steady_->cancel();
        if (refining_) refining_->cancel();
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void RenderWorker::show(std::shared_ptr<const Loaded> loaded) {
    const std::lock_guard lock(mutex_);
    shown_ = std::move(loaded);
    volume_changed_ = true;
    newest_.reset();
    last_frame_.reset();
    if (steady_) steady_->cancel();
    if (refining_) refining_->cancel();
    changed_.notify_all();
}

void RenderWorker::request(FrameRequest wanted) {
    const std::lock_guard lock(mutex_);
    newest_ = std::move(wanted);
    link_moved_ = true;  // what it waits for may be another
    if (refining_) refining_->cancel();
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    changed_.notify_all();
}

std::optional<LastFrame> RenderWorker::last_frame() const {
    const std::lock_guard lock(mutex_);
    return last_frame_;
}

void RenderWorker::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [&] { return ending_ || volume_changed_ || newest_; });
        if (ending_) return;
        if (volume_changed_) {
            change_volume(lock);
            continue;
        }
        if (const double wait = too_early(*newest_); wait > 0) {
            link_moved_ = false;
            changed_.wait_for(lock, std::chrono::duration<double>(wait),
                              [&] { return ending_ || volume_changed_ || link_moved_; });
            continue;
        }
        const FrameRequest wanted = std::move(*newest_);
        newest_.reset();
        steady_ = std::make_shared<Progress>();
        lock.unlock();
        try {
            if (session_) render_frame(wanted);
        } catch (...) {
            Json error = current_error(nullptr);
            error["n"] = wanted.n;
            if (error["code"] != "interrupted") callbacks_.tell(wanted.connection, error);
        }
        lock.lock();
        steady_.reset(), refining_.reset();
    }
}

void RenderWorker::look_at_link() {
    const std::lock_guard lock(mutex_);
    link_moved_ = true;
    changed_.notify_all();
}

/// Seconds until a picture of something that moves, if it were begun then, would find the way to the page free: of what
/// is drawn later the state is newer.
double RenderWorker::too_early(const FrameRequest& wanted) const {
    if (!wanted.moving || !session_) return 0;
    return callbacks_.link().free_in - resolution_.expected(draft_);
}

void RenderWorker::change_volume(std::unique_lock<std::mutex>& lock) {
    volume_changed_ = false;
    const auto shown = shown_;
    lock.unlock();
    next_.forget();
    session_.reset();  // its light goes before anything new comes
    if (shown) session_.emplace(shown->session.share_volume());
    loaded_ = shown;
    has_own_light_ = false;
    resolution_.forget();
    light_seconds_ = 1e9;
    lock.lock();
    voxels_.reset(), moment_ = 0;
}

std::optional<Session> RenderWorker::share(const Loaded& loaded, int moment) const {
    const std::lock_guard lock(mutex_);
    const bool is_shown = shown_.get() == &loaded && !volume_changed_ && moment == moment_ && voxels_;
    return is_shown ? std::optional(voxels_->share_volume()) : std::nullopt;
}

Session RenderWorker::share_shown(const Loaded& loaded) const {
    const std::lock_guard lock(mutex_);
    const bool is_shown = shown_.get() == &loaded && !volume_changed_ && voxels_;
    return is_shown ? voxels_->share_volume() : loaded.session.share_volume();
}

/// Goes on to the moment that is wanted, unless something newer is wanted by then. A scene that does not know yet what
/// its camera fits takes what fits the first moment.
bool RenderWorker::change_moment(FrameRequest& wanted) {
    std::shared_ptr<Progress> progress;
    {
        const std::lock_guard lock(mutex_);
        if (newest_ || volume_changed_ || ending_) return false;
        progress = refining_ = std::make_shared<Progress>(report_for(wanted));
    }
    if (moment_ == 0) wanted.scene.camera = session_->fit(wanted.scene, *progress);
    Session session = next_.take(*loaded_, wanted.scene, *progress);
    const bool is_first = wanted.scene.read.time == 0;
    {
        const std::lock_guard lock(mutex_);
        moment_ = wanted.scene.read.time;
        voxels_.reset();
        if (!is_first) voxels_.emplace(session.share_volume());
    }
    session_.reset();
    session_.emplace(std::move(session));
    has_own_light_ = false;
    return true;
}

void RenderWorker::render_frame(FrameRequest wanted) {
    is_refining_ = false;
    if (wanted.scene.read.time != moment_ && !change_moment(wanted)) return;
    if (wanted.next >= 0 && wanted.next != moment_) {
        Scene next = wanted.scene;
        next.read.time = wanted.next;
        next_.prepare(loaded_, next);
    }
    preview(wanted);
    wanted.scene.camera = session_->camera();  // what it fits was found for the first picture, and holds for all
    if (wanted.moving && !comes_to_rest(wanted)) return;
    std::shared_ptr<Progress> progress;
    {
        const std::lock_guard lock(mutex_);
        if (newest_ || volume_changed_ || ending_) return;
        progress = refining_ = std::make_shared<Progress>(report_for(wanted));
    }
    refine(wanted, *progress);
}

/// Whether nothing newer comes for a while.
bool RenderWorker::comes_to_rest(const FrameRequest& wanted) {
    std::unique_lock lock(mutex_);
    // States on a long way come less evenly.
    const auto uneven = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(std::min(0.5, callbacks_.link().round_trip)));
    const auto until = wanted.arrived + rest + uneven;
    return !changed_.wait_until(lock, until, [&] { return ending_ || volume_changed_ || newest_; });
}

Scene RenderWorker::as_draft(Scene scene) const {
    scene.width = draft_.width, scene.height = draft_.height;
    scene.sampling.step_voxels *= draft_.step_factor;
    return scene;
}

/// The picture that is shown at once, by the last computed lighting.
void RenderWorker::preview(const FrameRequest& wanted) {
    const auto start = Clock::now();
    Scene scene = with_samples(wanted.scene, 1);
    const double whole = resolution_.expected({scene.width, scene.height, still_quality});
    const bool is_fresh = awaits_light() && !(wanted.moving && light_seconds_ > quick_light);
    const bool is_slow = whole == 0 || whole > at_once;
    const bool is_small = wanted.moving || callbacks_.link().is_slow() || (is_slow && !is_fresh);
    draft_ = is_small ? resolution_.size(scene.width, scene.height, callbacks_.link())
                      : DraftSize{scene.width, scene.height,
                                  callbacks_.link().is_slow() ? still_far_quality : still_quality};
    // What the camera fits is found for the picture, not for a draft of it, whose sides are rounded.
    if (is_small && scene.camera.fit == Fit::visible && !scene.camera.fit_centre)
        scene.camera = session_->fit(wanted.scene, *steady_);
    if (scene.sampling.classification == Classification::preintegrated) draft_.step_factor = 1;  // a table is of a step
    scene = as_draft(std::move(scene));
    is_whole_ = scene.width == wanted.scene.width && scene.height == wanted.scene.height;
    if (!is_path_traced(scene.illumination) && session_->needs_light(scene) &&
        (is_fresh || light_seconds_ < instant_light))
        return preview_with_light(wanted, scene, *steady_);

    const bool is_soon = session_->needs_light(scene) && session_->is_lit_soon(scene);
    const Image& image = session_->preview(scene, *steady_, is_soon ? DraftLight::soon : DraftLight::last);
    double seconds = 0;
    for (const Stage& stage : session_->stages())
        if (stage.name == "raycast" || stage.name == "develop") seconds += stage.seconds;
    note_frame(wanted, scene);
    const double since = std::chrono::duration<double>(start - last_preview_).count();
    preview_interval_ = since < 0.5 ? 0.7 * preview_interval_ + 0.3 * since : 0;
    last_preview_ = start;
    const auto encoding = Clock::now();
    resolution_.learn_bytes(draft_, send(wanted, image, is_whole_ ? "full" : "draft", 1, is_soon));
    resolution_.learn(draft_, seconds + seconds_since(encoding));
    if (wanted.moving && is_light_due(scene)) preview_with_light(wanted, scene, *steady_);
}

bool RenderWorker::is_light_due(const Scene& scene) const {
    return light_seconds_ < quick_light && seconds_since(light_found_) > light_share * light_seconds_ &&
           !is_path_traced(scene.illumination) && session_->needs_light(scene);
}

/// Previews whose light is their own, the last one at its finest. While something moves they are not given up for a
/// newer request: else light would never follow a drag.
void RenderWorker::preview_with_light(const FrameRequest& wanted, const Scene& small, Progress& progress) {
    check_light_fits(small);
    has_own_light_ = true;
    const char* stage = is_whole_ ? "full" : "draft";
    const auto coarse = [&](const Image& image) { send(wanted, image, stage, 1, true); };
    const Image& image = session_->preview(small, progress, DraftLight::own, coarse);
    learn_light();
    note_frame(wanted, small);
    send(wanted, image, stage, 1);
}

/// Told rather than tried. Voxels stand for cells: of voxels that are no cubes there are more.
void RenderWorker::check_light_fits(const Scene& scene) const {
    const auto [nx, ny, nz] = session_->volume().dimensions();
    check_memory(light_bytes(scene.illumination, double(nx) * ny * nz) - double(session_->light_bytes()));
}

/// What it took, from the stages that find it.
void RenderWorker::learn_light() {
    double seconds = 0;
    for (const Stage& stage : session_->stages())
        if (stage.name == "prepare" || stage.name == "illuminate") seconds += stage.seconds;
    light_seconds_ = seconds;
    light_found_ = Clock::now();
}

void RenderWorker::note_frame(const FrameRequest& wanted, const Scene& scene) {
    const SourceLevel finest = session_->finest();
    LastFrame seen{wanted.n,
                   session_->medium(),
                   finest.geometry,
                   make_camera(session_->camera(), finest.geometry, finest.dimensions),
                   with_samples(scene, 1).sampling,
                   wanted.scene.width,
                   wanted.scene.height};
    const std::lock_guard lock(mutex_);
    if (!volume_changed_) last_frame_ = std::move(seen);
}

std::size_t RenderWorker::send(const FrameRequest& wanted, const Image& image, const char* stage, int samples,
                               bool is_coarse) {
    const bool is_final = std::string_view(stage) == "final";
    const LinkState link = callbacks_.link();
    const bool is_refined = is_refining_ && !is_final;
    if (is_refined && link.is_slow() && (link.free_in > nearly_free || wanted.scene.sampling.samples_per_pixel == 1))
        return 0;  // the final picture is all the sooner there
    Json header{{"n", wanted.n},
                {"kind", "state"},
                {"type", is_final ? "png" : "jpeg"},
                {"size", {image.width, image.height}},
                {"canvas", {wanted.scene.width, wanted.scene.height}},
                {"stage", stage},
                {"light", {{"coarse", is_coarse}, {"method", to_text(wanted.scene.illumination.method)}}},
                {"samples", samples},
                {"moving", wanted.moving},
                {"preview", wanted.preview},
                {"fps", wanted.moving && preview_interval_ > 0 ? Json(1 / preview_interval_) : Json()},
                {"verbs", json_of(session_->stages())},
                {"notes", wanted.notes}};
    if (loaded_->moments() > 1) header["moment"] = {{"voxels", moment_}, {"light", Json()}};
    if (loaded_->moments() > 1 && (has_own_light_ || holds_no_light(wanted.scene))) header["moment"]["light"] = moment_;
    header["probe_exposure"] = session_->probe_exposure();
    if (const CameraSettings& camera = session_->camera(); camera.fit == Fit::visible && camera.fit_centre)
        header["fit"] = {{"centre", json_of(*camera.fit_centre)}, {"radius", *camera.fit_radius_mm}};
    for (const std::string& note : session_->notes()) header["notes"].push_back(note);
    const int quality = !is_refining_ ? draft_.quality : link.is_slow() ? still_far_quality : still_quality;
    const std::string encoded_image = is_final ? as_text(encode_png(image)) : encode_jpeg(image, quality);
    header["seconds"] = seconds_since(wanted.arrived);
    callbacks_.frame(wanted.connection, frame_message(header, encoded_image));
    return encoded_image.size();
}

/// At most ten times a second, and not about what is quickly done.
Progress::Report RenderWorker::report_for(const FrameRequest& wanted) {
    const auto start = Clock::now();
    return [this, start, n = wanted.n, connection = wanted.connection, last = start + milliseconds(300)](
               std::string_view stage, double fraction) mutable {
        if (Clock::now() - last < milliseconds(100)) return;
        last = Clock::now();
        const double seconds = seconds_since(start);
        const Json remaining = fraction > 0.02 ? Json(seconds * (1 - fraction) / fraction) : Json();
        callbacks_.tell(connection, {{"type", "progress"},
                                     {"n", n},
                                     {"stage", stage},
                                     {"fraction", fraction},
                                     {"seconds", seconds},
                                     {"remaining_s", remaining}});
    };
}

}  // namespace chiaro::server

#include "painter.h"

#include <chiaro/text.h>

#include <algorithm>
#include <cmath>

#include "jpeg.h"
#include "room.h"

namespace chiaro::server {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr auto rest = milliseconds(120);
constexpr int moving_quality = 70, still_quality = 92;
// Light that is quicker than this is found while something moves, for an eighth of the time at most.
constexpr double quick_light = 0.15, light_share = 8, instant_light = 0.04;
// Light that is this quick needs no picture of the whole size by the last light before it.
constexpr double soon = 0.4;
// A picture of the whole size that takes no longer needs no smaller one before it.
constexpr double at_once = 0.06;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Json json_of(const std::vector<Stage>& stages) {
    Json list = Json::array();
    for (const Stage& stage : stages) list.push_back({{"name", stage.name}, {"seconds", stage.seconds}});
    return list;
}

std::string_view text_in(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Scene with_samples(Scene scene, int samples) {
    scene.sampling.samples_per_pixel = samples;
    return scene;
}

}  // namespace

Painter::~Painter() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        if (steady_) steady_->cancel();
        if (refining_) refining_->cancel();
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Painter::show(std::shared_ptr<const Loaded> loaded) {
    const std::lock_guard lock(mutex_);
    shown_ = std::move(loaded);
    volume_changed_ = true;
    newest_.reset();
    seen_.reset();
    if (steady_) steady_->cancel();
    if (refining_) refining_->cancel();
    changed_.notify_all();
}

void Painter::wish(Wish wish) {
    const std::lock_guard lock(mutex_);
    newest_ = std::move(wish);
    if (refining_) refining_->cancel();
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    changed_.notify_all();
}

std::optional<Seen> Painter::seen() const {
    const std::lock_guard lock(mutex_);
    return seen_;
}

void Painter::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [&] { return ending_ || volume_changed_ || newest_; });
        if (ending_) return;
        if (volume_changed_) {
            change_volume(lock);
            continue;
        }
        const Wish wish = std::move(*newest_);
        newest_.reset();
        steady_ = std::make_shared<Progress>();
        lock.unlock();
        try {
            if (session_) paint(wish);
        } catch (...) {
            Json error = current_error(nullptr);
            error["n"] = wish.n;
            if (error["code"] != "interrupted") outlet_.tell(wish.connection, error);
        }
        lock.lock();
        steady_.reset(), refining_.reset();
    }
}

void Painter::change_volume(std::unique_lock<std::mutex>& lock) {
    volume_changed_ = false;
    const auto shown = shown_;
    lock.unlock();
    session_.reset();  // its light goes before anything new comes
    if (shown) session_.emplace(shown->session.beside());
    pace_.forget();
    light_seconds_ = 1e9;
    lock.lock();
}

void Painter::paint(const Wish& wish) {
    draft(wish);
    if (wish.moving && !comes_to_rest(wish)) return;
    std::shared_ptr<Progress> progress;
    {
        const std::lock_guard lock(mutex_);
        if (newest_ || volume_changed_ || ending_) return;
        progress = refining_ = std::make_shared<Progress>(report_for(wish));
    }
    refine(wish, *progress);
}

/// Whether nothing newer comes for a while.
bool Painter::comes_to_rest(const Wish& wish) {
    std::unique_lock lock(mutex_);
    const auto until = std::max(wish.arrived, Clock::now() - milliseconds(60)) + rest;
    return !changed_.wait_until(lock, until, [&] { return ending_ || volume_changed_ || newest_; });
}

/// The picture that is shown at once, by the light at hand.
void Painter::draft(const Wish& wish) {
    const auto start = Clock::now();
    Scene scene = with_samples(wish.scene, 1);
    const double whole = double(scene.width) * scene.height;
    const bool is_small = wish.moving || pace_.expected(whole) == 0 || pace_.expected(whole) > at_once;
    if (is_small) std::tie(scene.width, scene.height) = pace_.size(scene.width, scene.height);
    is_whole_ = scene.width == wish.scene.width && scene.height == wish.scene.height;
    if (!is_path_traced(scene.illumination) && session_->needs_light(scene) && light_seconds_ < instant_light)
        return draft_with_light(wish, scene);

    const Image& image = session_->draft(scene, *steady_);
    double seconds = 0;
    for (const Stage& stage : session_->stages())
        if (stage.name == "raycast" || stage.name == "develop") seconds += stage.seconds;
    note_seen(wish, scene);
    const double since = std::chrono::duration<double>(start - last_draft_).count();
    draft_interval_ = since < 0.5 ? 0.7 * draft_interval_ + 0.3 * since : 0;
    last_draft_ = start;
    const auto encoding = Clock::now();
    send(wish, image, is_whole_ ? "full" : "draft", 1);
    pace_.learn(double(scene.width) * scene.height, seconds + seconds_since(encoding));
    if (wish.moving && is_light_due(scene)) draft_with_light(wish, scene);
}

bool Painter::is_light_due(const Scene& scene) const {
    return light_seconds_ < quick_light && seconds_since(light_found_) > light_share * light_seconds_ &&
           !is_path_traced(scene.illumination) && session_->needs_light(scene);
}

/// A draft whose light is its own. It is not given up for a newer wish: else light would never follow a drag.
void Painter::draft_with_light(const Wish& wish, const Scene& small) {
    check_light_fits(small);
    const Image& image = session_->render(small, *steady_);
    learn_light();
    note_seen(wish, small);
    send(wish, image, is_whole_ ? "full" : "draft", 1);
}

/// Told rather than tried. Voxels stand for cells: of voxels that are no cubes there are more.
void Painter::check_light_fits(const Scene& scene) const {
    const auto [nx, ny, nz] = session_->volume().dimensions();
    check_room(light_bytes(scene.illumination, double(nx) * ny * nz) - double(session_->light_bytes()));
}

void Painter::refine(const Wish& wish, Progress& progress) {
    if (is_path_traced(wish.scene.illumination))
        refine_traced(wish, progress);
    else
        refine_cast(wish, progress);
}

/// Light's own paths: better and better, pass by pass.
void Painter::refine_traced(const Wish& wish, Progress& progress) {
    if (wish.preview) return;
    auto sent = Clock::now();
    const auto show = [&](const Image& better) {
        if (seconds_since(sent) < 0.2) return;
        send(wish, better, "accumulate", 0);
        sent = Clock::now();
    };
    const Image& image = session_->render(wish.scene, progress, show);
    note_seen(wish, wish.scene);
    send(wish, image, "final", session_->outcome().paths.samples);
}

void Painter::refine_cast(const Wish& wish, Progress& progress) {
    const Scene once = with_samples(wish.scene, 1);
    const int samples = wish.scene.sampling.samples_per_pixel;
    const bool is_dark = session_->needs_light(once);
    if (is_dark) check_light_fits(once);
    if (is_dark && !is_whole_ && (wish.preview || light_seconds_ > soon)) {
        const Image& image = session_->draft(once, progress);
        note_seen(wish, once);
        send(wish, image, "full", 1);
    }
    if (wish.preview && (is_dark || is_whole_)) return;
    if (is_dark || !is_whole_) {
        const auto coarse = [&](const Image& image) { send(wish, image, "light", 1, true); };
        const Image& image = session_->render(once, progress, coarse);
        if (is_dark) learn_light();
        note_seen(wish, once);
        send(wish, image, is_dark ? "light" : "full", 1);
        if (wish.preview) return;
    }
    for (int finer = 4; finer < samples; finer *= 4)
        send(wish, session_->render(with_samples(wish.scene, finer), progress), "accumulate", finer);
    const Image& image = session_->render(wish.scene, progress);
    note_seen(wish, wish.scene);
    send(wish, image, "final", samples);
}

/// What it took, from the verbs that find it.
void Painter::learn_light() {
    double seconds = 0;
    for (const Stage& stage : session_->stages())
        if (stage.name == "prepare" || stage.name == "illuminate") seconds += stage.seconds;
    light_seconds_ = seconds;
    light_found_ = Clock::now();
}

void Painter::note_seen(const Wish& wish, const Scene& scene) {
    const DeviceVolume& volume = session_->volume();
    Seen seen{wish.n,
              session_->medium(),
              make_camera(scene.camera, volume.geometry(), volume.dimensions()),
              with_samples(scene, 1).sampling,
              wish.scene.width,
              wish.scene.height};
    const std::lock_guard lock(mutex_);
    if (!volume_changed_) seen_ = std::move(seen);
}

void Painter::send(const Wish& wish, const Image& image, const char* stage, int samples, bool is_coarse) {
    const bool is_final = std::string_view(stage) == "final";
    Json header{{"n", wish.n},
                {"kind", "state"},
                {"type", is_final ? "png" : "jpeg"},
                {"size", {image.width, image.height}},
                {"canvas", {wish.scene.width, wish.scene.height}},
                {"stage", stage},
                {"light", {{"coarse", is_coarse}, {"method", to_text(wish.scene.illumination.method)}}},
                {"samples", samples},
                {"moving", wish.moving},
                {"preview", wish.preview},
                {"fps", wish.moving && draft_interval_ > 0 ? Json(1 / draft_interval_) : Json()},
                {"verbs", json_of(session_->stages())},
                {"notes", wish.notes}};
    for (const std::string& note : session_->notes()) header["notes"].push_back(note);
    const bool is_draft = image.width != wish.scene.width || wish.moving;
    const std::string picture = is_final ? std::string(text_in(encode_png(image)))
                                         : encode_jpeg(image, is_draft ? moving_quality : still_quality);
    header["seconds"] = seconds_since(wish.arrived);
    outlet_.frame(wish.connection, frame_message(header, picture));
}

/// At most ten times a second, and not about what is quickly done.
Progress::Report Painter::report_for(const Wish& wish) {
    const auto start = Clock::now();
    return [this, start, n = wish.n, connection = wish.connection, last = start + milliseconds(300)](
               std::string_view stage, double fraction) mutable {
        if (Clock::now() - last < milliseconds(100)) return;
        last = Clock::now();
        const double seconds = seconds_since(start);
        const Json remaining = fraction > 0.02 ? Json(seconds * (1 - fraction) / fraction) : Json();
        outlet_.tell(connection, {{"type", "progress"},
                                  {"n", n},
                                  {"stage", stage},
                                  {"fraction", fraction},
                                  {"seconds", seconds},
                                  {"remaining_s", remaining}});
    };
}

}  // namespace chiaro::server

// What follows a draft of something that has come to rest: pictures of the whole size, better and better.
#include <algorithm>

#include "render_worker.h"

namespace chiaro::server {

using Clock = std::chrono::steady_clock;

// Light that is this quick needs no picture of the whole size by the last light before it.
constexpr double soon = 0.4;

void RenderWorker::refine(const FrameRequest& wanted, Progress& progress) {
    is_refining_ = true;
    if (is_path_traced(wanted.scene.illumination))
        refine_traced(wanted, progress);
    else
        refine_cast(wanted, progress);
}

/// Light's own paths: better and better, pass by pass.
void RenderWorker::refine_traced(const FrameRequest& wanted, Progress& progress) {
    if (wanted.preview) return;
    auto sent = Clock::now();
    const auto show = [&](const Image& better) {
        if (seconds_since(sent) < 0.2) return;
        send(wanted, better, "accumulate", 0);
        sent = Clock::now();
    };
    const Image& image = session_->render(wanted.scene, progress, show);
    note_frame(wanted, wanted.scene);
    send(wanted, image, "final", session_->render_statistics().paths.samples);
}

void RenderWorker::refine_cast(const FrameRequest& wanted, Progress& progress) {
    const Scene once = with_samples(wanted.scene, 1);
    const int samples = wanted.scene.sampling.samples_per_pixel;
    const bool is_dark = session_->needs_light(once);
    if (is_dark) check_light_fits(once);
    const double whole = resolution_.expected({once.width, once.height, still_quality});
    // No picture of the whole size by the light before is drawn where light is soon there, or while one is drawn.
    const bool takes_long = !session_->is_lit_soon(once) && light_seconds_ > std::max(soon, 2 * whole);
    const bool shows_last_light = wanted.preview || takes_long;
    if (is_dark && !is_whole_ && !awaits_light() && shows_last_light) {
        const Image& image = session_->preview(once, progress);
        note_frame(wanted, once);
        send(wanted, image, "full", 1);
    }
    if (wanted.preview && (is_dark || is_whole_)) return;
    if (is_dark && !is_whole_) preview_with_light(wanted, as_draft(once), progress);
    has_own_light_ = true;
    if (is_dark || !is_whole_ || session_->source()) {
        const auto coarse = [&](const Image& image) {  // light, or level of a volume by bricks
            const bool is_coarse_light = session_->light().is_coarse();
            send(wanted, image, is_coarse_light ? "light" : "full", 1, is_coarse_light);
        };
        const Image& image = session_->render(once, progress, coarse);
        if (is_dark && is_whole_) learn_light();
        note_frame(wanted, once);
        send(wanted, image, is_dark ? "light" : "full", 1);
        if (wanted.preview) return;
    }
    for (int finer = 4; finer < samples; finer *= 4)
        send(wanted, session_->render(with_samples(wanted.scene, finer), progress), "accumulate", finer);
    const Image& image = session_->render(wanted.scene, progress);
    note_frame(wanted, wanted.scene);
    send(wanted, image, "final", samples);
}

}  // namespace chiaro::server

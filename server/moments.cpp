#include "moments.h"

#include "core/user_cache.h"
#include "memory_budget.h"

namespace chiaro::server {

Session session_at(const Loaded& loaded, const Scene& scene, Progress& progress) {
    Session session = loaded.session.share_volume();
    if (scene.read.time == 0) return session;
    Scene moment = loaded.source;
    moment.read.time = scene.read.time;
    moment.read.max_bytes = std::max<std::uint64_t>(1, std::uint64_t(free_memory()));
    moment.read.spill = user_cache();
    Volume volume = read_volume(moment, progress);
    while (volume.dimensions[0] > session.volume().dimensions()[0]) volume = halved(volume);  // as the first one was
    session.show_moment(std::move(volume), progress);
    return session;
}

void NextMoment::prepare(std::shared_ptr<const Loaded> loaded, const Scene& scene) {
    if (moment_ == scene.read.time) return;
    forget();
    moment_ = scene.read.time;
    progress_ = std::make_shared<Progress>();
    session_ = std::async(std::launch::async, [loaded = std::move(loaded), scene, progress = progress_] {
        Session session = session_at(*loaded, scene, *progress);
        session.fit(scene, *progress);  // which classifies; a scene that knows its fit costs nothing more
        return session;
    });
}

Session NextMoment::take(const Loaded& loaded, const Scene& scene, Progress& progress) {
    if (moment_ != scene.read.time) return session_at(loaded, scene, progress);
    while (session_.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) progress.check();
    moment_ = -1;
    return session_.get();
}

void NextMoment::forget() {
    moment_ = -1;
    if (progress_) progress_->cancel();
    if (session_.valid()) session_.wait();
    session_ = {};
}

}  // namespace chiaro::server

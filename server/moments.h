// The moments of a volume that changes with time: beside the first, which stays in memory, the one that is shown and
// the next.
#pragma once
#include <future>

#include "volumes.h"

namespace chiaro::server {

/// A session that shows the scene's moment, read now unless it is the first. Throws as read_volume.
Session session_at(const Loaded& loaded, const Scene& scene, Progress& progress);

/// Reads and classifies a moment in a thread of its own, while another is looked at. Used by one thread.
class NextMoment {
public:
    NextMoment() = default;
    NextMoment(const NextMoment&) = delete;
    NextMoment& operator=(const NextMoment&) = delete;
    ~NextMoment() { forget(); }

    /// Begins with the scene's moment, unless that is under way or ready; what was begun before is given up.
    void prepare(std::shared_ptr<const Loaded> loaded, const Scene& scene);
    /// A session that shows the scene's moment: the prepared one, once it is ready, or one that is read now.
    Session take(const Loaded& loaded, const Scene& scene, Progress& progress);
    void forget();

private:
    int moment_ = -1;
    std::shared_ptr<Progress> progress_;
    std::future<Session> session_;
};

}  // namespace chiaro::server

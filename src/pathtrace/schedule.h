// When there are enough paths.
#pragma once
#include <chiaro/render.h>

#include <algorithm>
#include <chrono>

namespace chiaro {

/// How many paths come next, for each pixel: at first one, so that there is something to see at once, then more and
/// more, but no more than what is left of the time; none when it has passed or the error is small enough.
class PathSchedule {
public:
    PathSchedule(const ReferenceSettings& settings, int wanted) : settings_(settings), wanted_(wanted) {}

    int next(const PathStatistics& statistics) const {
        constexpr int most = 16, fewest_for_an_error = 8;
        const int done = statistics.samples;
        if (settings_.error && done >= fewest_for_an_error && statistics.relative_noise <= *settings_.error) return 0;
        double samples = std::min(std::clamp(done, 1, most), wanted_ - done);
        if (settings_.time_s && done > 0) {
            const double passed = std::max(std::chrono::duration<double>(Clock::now() - start_).count(), 1e-6);
            samples = std::min(samples, (*settings_.time_s - passed) / passed * done);
        }
        return int(std::max(samples, 0.0));
    }

private:
    using Clock = std::chrono::steady_clock;
    const ReferenceSettings& settings_;
    const int wanted_;
    const Clock::time_point start_ = Clock::now();
};

}  // namespace chiaro

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "pathtrace/tracer.h"
#include "raycast/background.h"

namespace chiaro {
namespace {

using Clock = std::chrono::steady_clock;

/// When a picture has had enough paths, and how many come next: at first one, so that there is something to see at
/// once, then more and more, but no more than what is left of the time.
class Schedule {
public:
    explicit Schedule(const ReferenceSettings& settings) : settings_(settings) {}

    int next(const PathStatistics& statistics) const {
        constexpr int most = 16, fewest_for_an_error = 8;
        const int done = statistics.samples;
        if (settings_.error && done >= fewest_for_an_error && statistics.relative_noise <= *settings_.error) return 0;
        double samples = std::min(std::clamp(done, 1, most), settings_.rays - done);
        if (settings_.time_s && done > 0) {
            const double passed = std::max(std::chrono::duration<double>(Clock::now() - start_).count(), 1e-6);
            samples = std::min(samples, (*settings_.time_s - passed) / passed * done);
        }
        return int(std::max(samples, 0.0));
    }

private:
    const ReferenceSettings& settings_;
    const Clock::time_point start_ = Clock::now();
};

}  // namespace

Outcome trace_paths(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
                    const RaySettings& rays, const IlluminationSettings& settings, Frame& frame, Progress& progress,
                    const FramePreview& preview) {
    const Schedule schedule(settings.reference);
    PathTracer tracer(device, medium, lighting, camera, rays, path_options(settings), frame.width, frame.height);
    Outcome outcome;
    const auto show = [&] {
        tracer.show(frame);
        if (lighting.probe.background)
            outcome.complete = put_probe_behind(device, lighting, camera, medium.data().shape.color, frame, progress);
    };
    const int wanted = settings.reference.rays;
    while (const int samples = schedule.next(outcome.paths)) {
        progress.report(fmt::format("paths {} of {}", outcome.paths.samples, wanted),
                        double(outcome.paths.samples) / wanted);
        outcome.complete = tracer.add(samples, progress);
        if (!outcome.complete) return outcome;
        outcome.paths = tracer.statistics();
        outcome.samples = tracer.collisions();
        if (!preview) continue;
        show();
        preview(frame);
    }
    show();
    return outcome;
}

}  // namespace chiaro

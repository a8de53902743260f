#include <fmt/format.h>

#include "pathtrace/schedule.h"
#include "pathtrace/tracer.h"
#include "raycast/background.h"

namespace chiaro {

Outcome trace_paths(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
                    const RaySettings& rays, const IlluminationSettings& settings, Frame& frame, Progress& progress,
                    const FramePreview& preview) {
    const PathSchedule schedule(settings.reference, settings.reference.rays);
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
        preview(frame, outcome.paths);
    }
    show();
    return outcome;
}

}  // namespace chiaro

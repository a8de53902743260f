#include <fmt/format.h>

#include "pathtrace/schedule.h"
#include "pathtrace/tracer.h"
#include "raycast/background.h"

namespace chiaro {
namespace {

/// `shown`, if there is one, is called after each pass that another follows.
Outcome follow(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
               const RaySettings& rays, const IlluminationSettings& settings, Filled& filled, Progress& progress,
               const std::function<void(const PathStatistics&)>& shown) {
    const PathSchedule schedule(settings.reference, settings.reference.rays);
    PathTracer tracer(device, medium, lighting, camera, rays, path_options(settings), filled.frame.width,
                      filled.frame.height);
    Outcome outcome;
    const auto show = [&] {
        tracer.show(filled);
        if (lighting.probe.background)
            outcome.complete = put_probe_behind(device, lighting, camera, medium.data().shape.color, filled, progress);
    };
    const int wanted = settings.reference.rays;
    while (const int samples = schedule.next(outcome.paths)) {
        progress.report(fmt::format("paths {} of {}", outcome.paths.samples, wanted),
                        double(outcome.paths.samples) / wanted);
        outcome.complete = tracer.add(samples, progress);
        if (!outcome.complete) return outcome;
        outcome.paths = tracer.statistics();
        outcome.samples = tracer.collisions();
        if (!shown) continue;
        show();
        shown(outcome.paths);
    }
    show();
    return outcome;
}

}  // namespace

Outcome trace_paths(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
                    const RaySettings& rays, const IlluminationSettings& settings, Frame& frame, Progress& progress,
                    const FramePreview& preview) {
    Filled filled{frame};
    std::function<void(const PathStatistics&)> shown;
    if (preview) shown = [&](const PathStatistics& paths) { filled.bring(), preview(frame, paths); };
    const Outcome outcome = follow(device, medium, lighting, camera, rays, settings, filled, progress, shown);
    filled.bring();
    return outcome;
}

Outcome trace_paths(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
                    const RaySettings& rays, const IlluminationSettings& settings, DeviceFrame& frame,
                    Progress& progress, const DeviceFramePreview& preview) {
    Filled filled{frame.write()};
    std::function<void(const PathStatistics&)> shown;
    if (preview) shown = [&](const PathStatistics& paths) { frame.keep_on_card(filled.pixels), preview(frame, paths); };
    const Outcome outcome = follow(device, medium, lighting, camera, rays, settings, filled, progress, shown);
    frame.keep_on_card(filled.pixels);
    return outcome;
}

}  // namespace chiaro

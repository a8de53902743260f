#include <fmt/format.h>

#include "pathtrace/schedule.h"
#include "pathtrace/tracer.h"
#include "raycast/background.h"

namespace chiaro {
namespace {

/// `shown`, if there is one, is called after each pass that another follows.
RenderStatistics follow(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
                        const RaySettings& rays, const IlluminationSettings& settings, RenderTarget& target,
                        Progress& progress, const std::function<void(const PathStatistics&)>& shown) {
    const PathSchedule schedule(settings.reference, settings.reference.rays);
    PathTracer tracer(device, medium, lighting, camera, rays, path_options(settings), target.frame.width,
                      target.frame.height);
    target.frame.depth_mm.clear();  // of an older picture
    RenderStatistics render_statistics;
    const auto show = [&] {
        tracer.show(target);
        if (lighting.probe.background)
            render_statistics.complete =
                put_probe_behind(device, lighting, camera, medium.data().shape.color, target, progress);
    };
    const int wanted = settings.reference.rays;
    while (const int samples = schedule.next(render_statistics.paths)) {
        progress.report(fmt::format("paths {} of {}", render_statistics.paths.samples, wanted),
                        double(render_statistics.paths.samples) / wanted);
        render_statistics.complete = tracer.add(samples, progress);
        if (!render_statistics.complete) return render_statistics;
        render_statistics.paths = tracer.statistics();
        render_statistics.samples = tracer.collisions();
        if (!shown) continue;
        show();
        shown(render_statistics.paths);
    }
    show();
    return render_statistics;
}

}  // namespace

RenderStatistics trace_paths(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
                             const RaySettings& rays, const IlluminationSettings& settings, Frame& frame,
                             Progress& progress, const FramePreview& preview) {
    RenderTarget target{frame};
    std::function<void(const PathStatistics&)> shown;
    if (preview) shown = [&](const PathStatistics& paths) { target.bring(), preview(frame, paths); };
    const RenderStatistics render_statistics =
        follow(device, medium, lighting, camera, rays, settings, target, progress, shown);
    target.bring();
    return render_statistics;
}

RenderStatistics trace_paths(const Device& device, const Medium& medium, const Lighting& lighting, const Camera& camera,
                             const RaySettings& rays, const IlluminationSettings& settings, DeviceFrame& frame,
                             Progress& progress, const DeviceFramePreview& preview) {
    RenderTarget target{frame.write()};
    std::function<void(const PathStatistics&)> shown;
    if (preview) shown = [&](const PathStatistics& paths) { frame.keep_on_gpu(target.pixels), preview(frame, paths); };
    const RenderStatistics render_statistics =
        follow(device, medium, lighting, camera, rays, settings, target, progress, shown);
    frame.keep_on_gpu(target.pixels);
    return render_statistics;
}

}  // namespace chiaro

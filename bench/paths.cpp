// The path tracer: CPU time of a frame with one path a pixel, and what majorants by region save.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "pathtrace/tracer.h"
#include "turntable.h"

namespace chiaro::bench {
namespace {

/// A scene's volume seen from its camera; colours as albedos, in linear light.
class Traced {
public:
    Traced(const Setup& setup, const Scene& scene)
        : device_(setup.device), progress_(setup.progress), width_(scene.width), height_(scene.height) {
        Volume volume = read_volume(scene, setup.progress);
        camera_ = make_camera(scene.camera, volume.geometry, volume.dimensions);
        medium_ = classify(upload(device_, std::move(volume)), scene.transfer.points.value(), {});
    }

    /// Milliseconds of one frame, up to 20 scatterings; what majorants cost is part of it.
    double frame(const Lighting& lighting, bool plain) {
        const PathOptions options{.bounces = 19, .albedo_max = 1, .plain = plain};
        const auto work = [&] {
            PathTracer tracer(device_, medium_, lighting, camera_, {}, options, width_, height_);
            tracer.add(1, progress_);
            collisions_ = double(tracer.collisions());
        };
        const double seconds = cpu_seconds(work);
        progress_.check();
        return 1e3 * seconds;
    }
    double paths() const { return double(width_) * height_; }
    double collisions() const { return collisions_; }

private:
    const Device device_;
    Progress& progress_;
    const int width_, height_;
    Camera camera_;
    Medium medium_;
    double collisions_ = 0;
};

std::string rate(const Traced& traced, double milliseconds) {
    return fmt::format("{:.1f} M paths/s, {:.1f} M collisions", 1e-3 * traced.paths() / milliseconds,
                       1e-6 * traced.collisions());
}

/// Under an even light, and under one that is drawn towards at every collision.
std::vector<Row> under_lights(const Setup& setup, const std::string& name, const Scene& scene) {
    Traced traced(setup, scene);
    Lighting studio;
    studio.loaded_probe = builtin_probe("studio");
    std::string white_rate, studio_rate;
    const auto time = [&](const Lighting& lighting, std::string& told) {
        const double milliseconds = traced.frame(lighting, false);
        told = rate(traced, milliseconds);
        return milliseconds;
    };
    const auto series =
        in_turns(setup.runs, {[&] { return time({}, white_rate); }, [&] { return time(studio, studio_rate); }});
    return {{name + "/white", "ms/frame", spread_of(series[0]), {}, {}, white_rate},
            {name + "/studio", "ms/frame", spread_of(series[1]), {}, {}, studio_rate}};
}

std::vector<Row> by_region(const Setup& setup, const std::string& name, const Scene& scene) {
    Traced traced(setup, scene);
    std::string told;
    const auto regions = [&] {
        const double milliseconds = traced.frame({}, false);
        told = rate(traced, milliseconds);
        return milliseconds;
    };
    const auto series = in_turns(setup.runs, {[&] { return traced.frame({}, true); }, regions});
    return {
        {name, "ms/frame", spread_of(series[1]), median_ratio(series[0], series[1]), "one majorant / by region", told}};
}

}  // namespace

std::vector<Case> path_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const char* kind : {"sparse", "opaque", "fog"}) {
        const std::string scene_name = fmt::format("shells256-{}", kind), name = "paths/" + scene_name;
        const auto rows = [&setup, name, white = name + "/white",
                           scene = find_scene(setup, scene_name)]() -> std::vector<Row> {
            if (!scene) return {{white, "ms/frame", {}, {}, {}, no_data}};
            return under_lights(setup, name, *scene);
        };
        cases.push_back({{name + "/white", name + "/studio"}, rows});
    }
    for (const char* scene_name : {"shells256-sparse", "aneurism"}) {
        const std::string name = fmt::format("paths/{}/majorants", scene_name);
        const auto rows = [&setup, name, scene = find_scene(setup, scene_name)]() -> std::vector<Row> {
            if (!scene) return {{name, "ms/frame", {}, {}, {}, no_data}};
            return by_region(setup, name, *scene);
        };
        cases.push_back({{name}, rows});
    }
    return cases;
}

}  // namespace chiaro::bench

// The scenes of bench/scenes, at two steps, shaded and not, and in other ways: CPU time of a frame, from the
// camera to the image.
#include <fmt/format.h>

#include <algorithm>

#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr const char* frame_unit = "ms/frame";

Row measure(const Setup& setup, Turntable& turntable, const std::string& name, const Scene& scene) {
    const auto series = in_turns(setup.runs, {[&] { return 1e3 * turntable.seconds_per_frame(scene); }});
    const double samples = double(turntable.samples_per_frame());
    return {name, frame_unit, spread_of(series[0]), {}, {}, fmt::format("{:.1f} M samples", 1e-6 * samples)};
}

void add_scene(const Setup& setup, const std::string& scene_name, std::vector<Case>& cases) {
    const auto scene = find_scene(setup, scene_name);
    const Shared<Turntable> turntable([&setup, scene] { return Turntable(setup, *scene); });
    for (const double step : {1.0, 0.5})
        for (const bool shaded : {false, true}) {
            const std::string shading = shaded ? "shaded" : "unshaded";
            const std::string name = fmt::format("scenes/{}/step-{}/{}", scene_name, step, shading);
            const auto row = [=, &setup]() -> std::vector<Row> {
                if (!scene) return {{name, frame_unit, {}, {}, {}, no_data}};
                Scene variant = *scene;
                variant.sampling.step_voxels = step;
                variant.lighting.shading = shaded ? Shading::phong : Shading::none;
                return {measure(setup, *turntable, name, variant)};
            };
            cases.push_back({{name}, row});
        }
}

/// Another way to look at a scene, beside the usual one: post-classified volume, front to back, rays from the box.
struct Way {
    const char* name;
    std::function<void(Scene&)> change;
};

/// An isosurface where the scene's transfer function is half way from transparent to its most opaque.
double middle_value(const Scene& scene) {
    const auto& points = scene.transfer.points->points;
    double most = 0;
    for (const ControlPoint& p : points) most = std::max(most, p.opacity);
    for (const ControlPoint& p : points)
        if (p.opacity >= most / 2) return p.value;
    return points.back().value;
}

const std::vector<Way>& ways() {
    static const std::vector<Way> all{
        {"iso", [](Scene& s) { s.mode = Mode::iso, s.iso = {{middle_value(s)}}; }},
        {"mip", [](Scene& s) { s.mode = Mode::mip; }},
        {"pre", [](Scene& s) { s.sampling.classification = Classification::pre; }},
        {"preintegrated", [](Scene& s) { s.sampling.classification = Classification::preintegrated; }},
        {"back-to-front", [](Scene& s) { s.sampling.compositing = Compositing::back_to_front; }},
        {"raster", [](Scene& s) { s.sampling.ray_setup = RaySetup::raster; }},
        {"no-skipping", [](Scene& s) { s.sampling.skip_empty = false; }},
        {"no-skipping-raster",
         [](Scene& s) { s.sampling.skip_empty = false, s.sampling.ray_setup = RaySetup::raster; }}};
    return all;
}

/// In turns with the usual way; its time over that one's.
Row measure_beside(const Setup& setup, Turntable& turntable, const std::string& name, const Scene& usual,
                   const Scene& other) {
    const auto time = [&](const Scene& scene) { return 1e3 * turntable.seconds_per_frame(scene); };
    const auto series = in_turns(setup.runs, {[&] { return time(usual); }, [&] { return time(other); }});
    return {name, frame_unit, spread_of(series[1]), median_ratio(series[1], series[0]), "dvr in the usual way", {}};
}

void add_ways(const Setup& setup, const std::string& scene_name, std::vector<Case>& cases) {
    const auto scene = find_scene(setup, scene_name);
    const Shared<Turntable> turntable([&setup, scene] { return Turntable(setup, *scene); });
    for (const Way& way : ways()) {
        const std::string name = fmt::format("ways/{}/{}", scene_name, way.name);
        const auto row = [=, &setup]() -> std::vector<Row> {
            if (!scene) return {{name, frame_unit, {}, {}, {}, no_data}};
            Scene other = *scene;
            way.change(other);
            return {measure_beside(setup, *turntable, name, *scene, other)};
        };
        cases.push_back({{name}, row});
    }
}

}  // namespace

std::vector<Case> way_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const char* scene : {"aneurism", "shells256-sparse", "shells256-opaque", "shells256-fog"})
        add_ways(setup, scene, cases);
    return cases;
}

std::vector<Case> scene_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const SceneText& text : scene_texts()) {
        const std::string scene = text.name;
        if (setup.quick && scene.starts_with("shells512")) continue;
        add_scene(setup, scene, cases);
    }
    return cases;
}

}  // namespace chiaro::bench

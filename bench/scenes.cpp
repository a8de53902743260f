// The scenes of bench/scenes, at two steps, shaded and not: processor time of a frame, from the camera to the image.
#include <fmt/format.h>

#include "turntable.h"

namespace chiaro::bench {
namespace {

constexpr const char* unit = "ms/frame";

Row measure(const Setup& setup, Turntable& turntable, const std::string& name, const Scene& scene) {
    const auto series = in_turns(setup.runs, {[&] { return 1e3 * turntable.seconds_per_frame(scene); }});
    const double samples = double(turntable.samples_per_frame());
    return {name, unit, spread_of(series[0]), {}, {}, fmt::format("{:.1f} M samples", 1e-6 * samples)};
}

void add_scene(const Setup& setup, const std::string& scene_name, std::vector<Case>& cases) {
    const auto scene = find_scene(setup, scene_name);
    const Shared<Turntable> turntable([&setup, scene] { return Turntable(setup, *scene); });
    for (const double step : {1.0, 0.5})
        for (const bool shaded : {false, true}) {
            const std::string shading = shaded ? "shaded" : "unshaded";
            const std::string name = fmt::format("scenes/{}/step-{}/{}", scene_name, step, shading);
            const auto row = [=, &setup]() -> std::vector<Row> {
                if (!scene) return {{name, unit, {}, {}, {}, no_data}};
                Scene variant = *scene;
                variant.sampling.step_voxels = step;
                variant.lighting.shading = shaded ? Shading::phong : Shading::none;
                return {measure(setup, *turntable, name, variant)};
            };
            cases.push_back({{name}, row});
        }
}

}  // namespace

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

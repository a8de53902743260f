// The scenes of bench/scenes, at two steps, shaded and not: processor time of a frame.
#include <fmt/format.h>

#include "turntable.h"

namespace chiaro::bench {
namespace {

Row measure(const Setup& setup, Turntable& turntable, const std::string& name, double step, bool shaded) {
    if (!turntable.has_data()) return {name, "ms/frame", {}, {}, {}, no_data};
    turntable.scene().sampling.step_voxels = step;
    turntable.scene().lighting.shading = shaded ? Shading::phong : Shading::none;
    const auto series = in_turns(setup.runs, {[&] { return 1e3 * turntable.seconds_per_frame(); }});
    return {name, "ms/frame", spread_of(series[0]),
            {},   {},         fmt::format("{:.1f} M samples", 1e-6 * double(turntable.samples_per_frame()))};
}

}  // namespace

std::vector<Case> scene_cases(const Setup& setup) {
    std::vector<Case> cases;
    for (const SceneText& text : scene_texts()) {
        const std::string scene = text.name;
        if (setup.quick && scene.starts_with("shells512")) continue;
        const Shared<Turntable> turntable([&setup, scene] { return Turntable(setup, scene); });
        for (const double step : {1.0, 0.5})
            for (const bool shaded : {false, true}) {
                const std::string name =
                    fmt::format("scenes/{}/step-{}/{}", scene, step, shaded ? "shaded" : "unshaded");
                cases.push_back(
                    {{name}, [=, &setup] { return std::vector{measure(setup, *turntable, name, step, shaded)}; }});
            }
    }
    return cases;
}

}  // namespace chiaro::bench

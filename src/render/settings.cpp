#include <chiaro/describe.h>

namespace chiaro {
namespace {

/// Of settings that replace each other, those of the scene that what is given puts away.
void put_away(Scene& scene, const GivenSettings& given) {
    const auto is_given = [&](std::string_view name) { return given.contains(name); };
    if (is_given("transfer")) scene.transfer.points.reset();
    if (is_given("transfer") || is_given("opacity-unit") || is_given("opacity-unit-mm"))
        scene.transfer.opacity_unit.reset(), scene.transfer.opacity_unit_mm.reset();
    if (is_given("background")) scene.lighting.probe.background = false;
    const bool turns_orbit = is_given("azimuth") || is_given("elevation") || is_given("view");
    const bool is_aimed = is_given("eye") || is_given("target"), is_matrix = is_given("camera-matrix");
    if (turns_orbit || is_matrix) scene.camera.eye.reset(), scene.camera.target.reset();
    if (turns_orbit || is_aimed) scene.camera.matrix.reset();
    if (turns_orbit || is_aimed || is_matrix) scene.camera.view.reset(), scene.camera.by_frame = false;
    if (is_given("up")) scene.camera.by_frame = false;
    if (is_given("probe-rotation")) scene.lighting.probe.by_frame = false;
    if (is_given("fit")) scene.camera.fit_centre.reset(), scene.camera.fit_radius_mm.reset();  // found anew
}

template <class T>
bool take_back(std::optional<T>& field) {
    field.reset();
    return true;
}
bool take_back(auto&...) { return false; }

}  // namespace

void set_by_name(Scene& scene, const GivenSettings& given,
                 const std::function<std::string(std::string_view, std::string_view)>& written) {
    put_away(scene, given);
    for_each_setting(
        [&](const Setting& setting, auto&... fields) {
            const auto found = given.find(setting.name);
            if (setting.name.empty() || found == given.end()) return;
            if (found->second.empty() && take_back(fields...)) return;
            set(setting, found->second, written(setting.name, found->second), ErrorCode::usage, fields...);
        },
        scene);
    check(scene, ErrorCode::usage);
}

}  // namespace chiaro

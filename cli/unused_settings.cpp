#include "unused_settings.h"

#include <chiaro/text.h>
#include <fmt/format.h>

namespace chiaro::cli {
namespace {

/// Settings of one method alone, by how their names begin.
struct OfMethod {
    std::string_view begin;
    Method method;
};
constexpr OfMethod of_methods[] = {{"spao-", Method::spao},
                                   {"sh-", Method::visibility},
                                   {"hist-", Method::histogram},
                                   {"transport-", Method::transport},
                                   {"reference-", Method::reference}};

bool is_lit_by_probe(const IlluminationSettings& light) {
    return light.method == Method::visibility || light.method == Method::transport || is_path_traced(light);
}

/// Why a setting changes nothing; empty where it does, or might.
std::string why_unused(std::string_view name, const Scene& scene) {
    const Method method = scene.illumination.method;
    const CameraSettings& camera = scene.camera;
    const auto is = [&](auto... names) { return ((name == names) || ...); };
    if (is("iso") && scene.mode != Mode::iso) return "isosurfaces are what --mode iso shows";
    if (is("focus") && camera.aperture_mm == 0) return "without --aperture all is sharp";
    const bool is_orbit = is("azimuth", "elevation");
    if (is_orbit && camera.view) return "--view says where the camera is";
    const bool zooms = is("zoom") && camera.projection == Projection::perspective;
    if ((is_orbit || zooms) && camera.eye) return "--eye and --target say where the camera is";
    const bool is_of_light = is("lighting", "light", "probe", "probe-rotation", "probe-exposure", "glow", "surfaces");
    bool is_of_method = false;
    for (const OfMethod& of : of_methods) {
        if (!name.starts_with(of.begin)) continue;
        is_of_method = true;
        if (is_lit(scene.mode) && method != of.method)
            return fmt::format("it belongs to --lighting {}; the light is --lighting {}", to_text(of.method),
                               to_text(method));
    }
    if (!is_lit(scene.mode) && (is_of_light || is_of_method) && !(is("lighting") && method == Method::none) &&
        !((name.starts_with("probe") || is("light")) && scene.lighting.probe.background))
        return fmt::format("--mode {} shows no light", to_text(scene.mode));
    if (is("light") && is_lit_by_probe(scene.illumination) && scene.lighting.probe.source != "lights")
        return fmt::format("--lighting {} takes its light from --probe (--probe lights has these)", to_text(method));
    if (is("probe", "probe-rotation", "probe-exposure") && !is_lit_by_probe(scene.illumination) &&
        !scene.lighting.probe.background)
        return fmt::format("--lighting {} takes no light from a probe; visibility, transport and reference do",
                           to_text(method));
    if (is("glow") && method != Method::histogram) return "it belongs to --lighting histogram";
    if (is("glow") && !scene.illumination.histogram.effects.emission) return "--hist-effects does not name glow";
    return {};
}

}  // namespace

std::vector<std::string> unused_settings(const GivenSettings& given, const Scene& scene) {
    std::vector<std::string> sentences;
    for (const auto& [name, value] : given)
        if (const std::string why = why_unused(name, scene); !why.empty())
            sentences.push_back(fmt::format("--{} changes nothing: {}", name, why));
    return sentences;
}

}  // namespace chiaro::cli

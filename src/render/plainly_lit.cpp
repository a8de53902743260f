#include "render/plainly_lit.h"
#include "render/appearance.h"

#include "illumination/probe/light.h"

namespace chiaro {

namespace {

bool takes_probe(Method method) {
    return method == Method::visibility || method == Method::transport || method == Method::reference;
}

/// Light of a white probe alone: what is left of it is occlusion.
void light_evenly(Scene& scene) {
    scene.lighting.probe = {};
    scene.lighting.loaded_probe = {};
    scene.lighting.strength = 1;
    scene.lighting.shading = Shading::none;
    scene.illumination.histogram.effects = {.ao = true, .bleeding = false};
}

}  // namespace

Scene as_shown(const Scene& scene, Method method) {
    Scene shown = scene;
    shown.illumination.method = method;
    shown.lighting.probe.background = false;
    shown.output = {};
    shown.output.color = scene.output.color;
    if (!takes_probe(method)) light_evenly(shown);
    return shown;
}

Scene reference_of(const Scene& scene, Method method) {
    Scene truth = as_shown(scene, method);
    truth.illumination.method = Method::reference;
    truth.illumination.reference.quantity = ReferenceQuantity::radiance;
    truth.lighting.strength = 1;
    if (method != Method::transport && method != Method::reference) truth.illumination.scattering.bounces.most = 0;
    return truth;
}

std::string light_of_reference(const Scene& scene, Method method) {
    if (!takes_probe(method)) return "white, scattered once";
    const auto most = reference_of(scene, method).illumination.scattering.bounces.most;
    if (!most) return "scattered until it has left";
    return *most == 0 ? "scattered once" : "scattered " + std::to_string(*most + 1) + " times at most";
}

Scene plainly_lit(const Scene& scene, Method method) {
    Scene plain = scene;
    plain.lighting.shading = Shading::none;
    plain.lighting.strength = 1;
    plain.lighting.probe.background = false;
    plain.lighting.floor = {};
    if (!has_finer_interpolation(scene)) plain.interpolation = Interpolation::linear;
    plain.sampling.classification = Classification::preintegrated;  // paths miss nothing that a step passes
    plain.sampling.early_termination = 0;
    plain.output = {};
    IlluminationSettings& light = plain.illumination;
    light.method = method;
    light.surfaces = SurfaceModel::none;
    light.spao.normal_factor = 0;
    light.visibility.model = VisibilityModel::paper;
    light.histogram.model = HistogramModel::corrected;
    light.histogram.effects = {.ao = true, .bleeding = false};
    light.reference.quantity = ReferenceQuantity::radiance;
    light.scattering.bounces.most = 0;
    light.scattering.anisotropy = 0;
    return plain;
}

bool finds_light(const IlluminationSettings& settings) {
    return settings.method == Method::visibility || settings.method == Method::transport || is_path_traced(settings);
}

Rgb mean_radiance(const Lighting& lighting) {
    return sh_light(lighting, {0, 0, 1}, {}, ShWindow::none).mean;  // which no rotation changes
}

}  // namespace chiaro

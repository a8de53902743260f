#include "render/plainly_lit.h"

#include "illumination/probe/light.h"

namespace chiaro {

Scene plainly_lit(const Scene& scene, Method method) {
    Scene plain = scene;
    plain.lighting.shading = Shading::none;
    plain.lighting.strength = 1;
    plain.lighting.probe.background = false;
    plain.sampling.classification = Classification::preintegrated;  // paths miss nothing that a step passes
    plain.sampling.early_termination = 0;
    plain.output = {};
    IlluminationSettings& light = plain.illumination;
    light.method = method;
    light.on_particles = true;
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

#include <chiaro/comparison.h>
#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>

#include "illumination/probe/light.h"

namespace chiaro {
namespace {

/// What all methods are asked alike.
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

/// Of the verbs that are named.
double seconds_of(const std::vector<Stage>& stages, std::initializer_list<std::string_view> verbs) {
    double sum = 0;
    for (const Stage& stage : stages)
        if (std::find(verbs.begin(), verbs.end(), stage.name) != verbs.end()) sum += stage.seconds;
    return sum;
}

void put_over_black(Frame& frame) {
    for (std::size_t alpha = 3; alpha < frame.rgba.size(); alpha += 4) frame.rgba[alpha] = 1;
}

/// Methods that know a share of light and no direction: the share of the probe's mean.
void light_by_mean(Frame& frame, Rgb mean) {
    for (std::size_t i = 0; i < frame.rgba.size(); i += 4)
        for (std::size_t c = 0; c < 3; ++c) frame.rgba[i + c] *= float(mean[c]);
}

Rgb mean_radiance(const Lighting& lighting) {
    Lighting loaded = lighting;
    if (!loaded.probe.source.empty()) loaded.loaded_probe = load_probe(loaded.probe.source);
    return sh_light(loaded, {0, 0, 1}, {}, ShWindow::none).mean;  // which no rotation changes
}

MethodPicture picture_by(Session& session, const Scene& scene, Progress& progress) {
    session.render(scene, progress);
    MethodPicture picture{scene.illumination.method, session.frame(), 0, 0, 0, {}};
    picture.light_seconds = seconds_of(session.stages(), {"prepare", "illuminate"});
    picture.light_bytes = session.light_bytes();
    if (!is_path_traced(scene.illumination)) {
        // Again, by light that is all there: what a moved camera costs.
        Scene moved = scene;
        moved.camera.zoom *= 1 + 1e-9;
        session.render(moved, progress);
    }
    picture.frame_seconds = seconds_of(session.stages(), {"raycast"});
    put_over_black(picture.frame);
    return picture;
}

}  // namespace

MethodComparison compare_methods(Session& session, const Scene& scene, const std::vector<Method>& methods,
                                 Progress& progress) {
    if (scene.mode != Mode::dvr)
        throw Error(ErrorCode::usage,
                    fmt::format("--mode {}: lighting methods are compared in volumes, mode dvr", to_text(scene.mode)));
    MethodComparison comparison;
    const Rgb mean = mean_radiance(scene.lighting);
    comparison.reference = picture_by(session, plainly_lit(scene, Method::reference), progress);
    comparison.paths = session.outcome().paths.samples;
    comparison.noise = session.outcome().paths.noise;
    for (const Method method : methods) {
        MethodPicture picture = picture_by(session, plainly_lit(scene, method), progress);
        const bool knows_light =
            method == Method::visibility || method == Method::transport || method == Method::reference;
        if (!knows_light) light_by_mean(picture.frame, mean);
        picture.distance = compare(comparison.reference.frame, picture.frame);
        comparison.pictures.push_back(std::move(picture));
    }
    return comparison;
}

}  // namespace chiaro

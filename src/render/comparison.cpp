#include <chiaro/comparison.h>
#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>

#include "render/appearance.h"
#include "render/plainly_lit.h"

namespace chiaro {
namespace {

/// Of the stages that are named.
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

MethodImage image_by(Session& session, const Scene& scene, Progress& progress, const Preview& preview = {}) {
    session.render(scene, progress, preview);
    MethodImage image{scene.illumination.method, session.frame(), 0, 0, 0, {}};
    image.light_seconds = seconds_of(session.stages(), {"prepare", "illuminate"});
    image.light_bytes = session.light_bytes();
    if (!is_path_traced(scene.illumination)) {
        // Again, by light that is all there: what a moved camera costs.
        Scene moved = scene;
        moved.camera.zoom *= 1 + 1e-9;
        session.render(moved, progress);
    }
    image.frame_seconds = seconds_of(session.stages(), {"raycast"});
    put_over_black(image.frame);
    return image;
}

}  // namespace

MethodComparison compare_methods(Session& session, const Scene& scene, const std::vector<Method>& methods,
                                 Progress& progress, const ComparisonPreview& preview) {
    if (scene.mode != Mode::dvr)
        throw Error(ErrorCode::usage,
                    fmt::format("--mode {}: lighting methods are compared in volumes, mode dvr", to_text(scene.mode)));
    MethodComparison comparison;
    const Rgb mean = mean_radiance(with_probe(scene.lighting));
    for (const Method method : methods) {
        const Scene plain = plainly_lit(scene, method);
        MethodImage image = image_by(session, plain, progress);
        if (!finds_light(plain.illumination)) light_by_mean(image.frame, mean);
        comparison.images.push_back(std::move(image));
    }
    const auto judge = [&](MethodImage reference) {
        comparison.reference = std::move(reference);
        comparison.paths = session.render_statistics().paths.samples;
        comparison.noise = session.render_statistics().paths.noise;
        for (MethodImage& image : comparison.images) image.distance = compare(comparison.reference.frame, image.frame);
    };
    const auto show = [&](const Image&) {
        MethodImage partial{Method::reference, session.frame(), 0, 0, 0, {}};
        put_over_black(partial.frame);
        judge(std::move(partial));
        preview(comparison);
    };
    judge(image_by(session, plainly_lit(scene, Method::reference), progress, preview ? show : Preview()));
    return comparison;
}

}  // namespace chiaro

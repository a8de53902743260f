#include <chiaro/comparison.h>
#include <chiaro/error.h>
#include <chiaro/text.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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
    MethodImage image{scene.illumination.method, session.frame(), 0, 0, 0, {}, 0, 0};
    image.light_seconds = seconds_of(session.stages(), {"prepare", "illuminate"});
    image.light_bytes = session.light_bytes();
    if (!is_path_traced(scene.illumination)) {
        // Again, by light that is all there: what a moved camera costs.
        Scene moved = scene;
        moved.camera.zoom *= 1 + 1e-9;
        session.render(moved, progress);
    }
    image.frame_seconds = seconds_of(session.stages(), {"raycast"});
    return image;
}

/// See MethodImage::block_error; frames with their opacity.
double block_error(const Frame& truth, const Frame& found) {
    constexpr int edge = 8;
    double squares = 0, light = 0;
    int blocks = 0;
    for (int top = 0; top + edge <= truth.height; top += edge)
        for (int left = 0; left + edge <= truth.width; left += edge) {
            std::array<double, 4> a{}, b{};
            for (int y = top; y < top + edge; ++y)
                for (int x = left; x < left + edge; ++x)
                    for (std::size_t c = 0; c < 4; ++c) {
                        const std::size_t at = 4 * (std::size_t(y) * truth.width + x) + c;
                        a[c] += double(truth.rgba[at]) / (edge * edge), b[c] += double(found.rgba[at]) / (edge * edge);
                    }
            if (a[3] < 0.5) continue;
            ++blocks;
            for (std::size_t c = 0; c < 3; ++c) light += a[c] / 3, squares += (a[c] - b[c]) * (a[c] - b[c]) / 3;
        }
    return light > 0 ? std::sqrt(squares / blocks) / (light / blocks) : 0;
}

/// Which methods are judged by the same reference: all, as particles.
int kind_of(const Scene& scene, Method method) {
    if (!shows_surfaces(scene.illumination) || method == Method::transport) return 0;
    return method == Method::visibility ? 1 : 2;
}

/// How far the methods that a reference judges are from it.
void judge(const MethodReference& reference, std::size_t index, MethodComparison& comparison) {
    const auto over_black = [](Frame frame) {
        put_over_black(frame);
        return frame;
    };
    for (MethodImage& image : comparison.images) {
        if (image.reference != index) continue;
        image.distance = compare(over_black(reference.image.frame), over_black(image.frame));
        image.block_error = block_error(reference.image.frame, image.frame);
    }
}

/// Frames are handed out over black.
MethodComparison handed_out(MethodComparison comparison) {
    for (MethodImage& image : comparison.images) put_over_black(image.frame);
    for (MethodReference& reference : comparison.references) put_over_black(reference.image.frame);
    return comparison;
}

}  // namespace

MethodComparison compare_methods(Session& session, const Scene& scene, const std::vector<Method>& methods,
                                 Progress& progress, const ComparisonPreview& preview) {
    if (scene.mode != Mode::dvr)
        throw Error(ErrorCode::usage,
                    fmt::format("--mode {}: lighting methods are compared in volumes, mode dvr", to_text(scene.mode)));
    const bool on_surfaces = shows_surfaces(scene.illumination);
    MethodComparison comparison;
    std::vector<int> kinds;        // of the references
    std::vector<Method> judged{};  // the first method of each
    const Rgb mean = mean_radiance(with_probe(scene.lighting));
    for (const Method method : methods) {
        const Scene lit = on_surfaces ? as_shown(scene, method) : plainly_lit(scene, method);
        MethodImage image = image_by(session, lit, progress);
        if (!on_surfaces && !finds_light(lit.illumination)) light_by_mean(image.frame, mean);
        const int kind = kind_of(scene, method);
        image.reference = std::size_t(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
        if (image.reference == kinds.size()) kinds.push_back(kind), judged.push_back(method);
        comparison.images.push_back(std::move(image));
    }
    if (judged.empty()) judged.push_back(Method::reference);  // it alone
    for (std::size_t i = 0; i < judged.size(); ++i) {
        const Scene truth = on_surfaces ? reference_of(scene, judged[i]) : plainly_lit(scene, Method::reference);
        comparison.references.push_back(
            {{}, on_surfaces ? light_of_reference(scene, judged[i]) : "on particles, scattered once"});
        const auto keep = [&](MethodImage image) {
            MethodReference& reference = comparison.references[i];
            reference.image = std::move(image), reference.image.reference = i;
            reference.paths = session.render_statistics().paths.samples;
            reference.noise = session.render_statistics().paths.noise;
            judge(reference, i, comparison);
        };
        const auto show = [&](const Image&) {
            keep({Method::reference, session.frame(), 0, 0, 0, {}, 0, i});
            preview(handed_out(comparison));
        };
        keep(image_by(session, truth, progress, preview ? show : Preview()));
    }
    return handed_out(std::move(comparison));
}

}  // namespace chiaro

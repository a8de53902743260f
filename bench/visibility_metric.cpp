#include "visibility_metric.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "classify/medium.h"
#include "illumination/sh/directions.h"
#include "illumination/visibility/visibility.h"
#include "illumination/visibility/walk.h"

namespace chiaro::bench {
namespace {

constexpr int width = 16;

std::vector<std::array<int, 3>> chosen_runs(const CellGrid& grid, int count) {
    std::vector<std::array<int, 3>> runs;
    std::uint64_t counter = 0;
    const auto below = [&](int n) { return int(scrambled(counter++) % std::uint64_t(std::max(n, 1))); };
    for (int i = 0; i < count; ++i)
        runs.push_back({below(grid.count[0] - width + 1), below(grid.count[1]), below(grid.count[2])});
    return runs;
}

ShLight light_of(const std::string& probe) {
    Lighting lighting;
    lighting.loaded_probe = load_probe(probe);
    return sh_light(lighting, {0, 0, 1}, Geometry{}, ShWindow::none);
}

}  // namespace

std::vector<NamedLight> judging_lights(const std::filesystem::path& volumes) {
    std::vector<NamedLight> lights;
    for (const auto& [file, ours] : {std::pair{"studio.hdr", "studio"}, {"sunrise.hdr", "sky"}}) {
        const std::filesystem::path path = volumes.parent_path() / "probes" / file;
        std::error_code unreadable;
        const bool is_there = !volumes.empty() && std::filesystem::exists(path, unreadable);
        lights.push_back({is_there ? file : ours, light_of(is_there ? path.string() : ours)});
    }
    return lights;
}

VisibilityErrorMetric::VisibilityErrorMetric(const LitSubject& subject, int subsample, int runs, int rays,
                                             Progress& progress)
    : device_(subject.device),
      subsample_(subsample),
      progress_(progress),
      density_(density_for(subject.medium.data(), subsample, device_, progress)),
      runs_(chosen_runs(density_.grid, runs)),
      by_rays_(trace_harmonics(device_, ExtinctionCells(density_, 1, device_, progress), 1, 2 * start(), rays, runs_,
                               progress)) {
    if (subsample == 1) return;
    const Density cells = density_for(subject.medium.data(), 1, device_, progress);
    in_full_ = trace_harmonics(device_, ExtinctionCells(cells, subsample, device_, progress), subsample, 1, rays, runs_,
                               progress);
}

template <class Visit>
void VisibilityErrorMetric::for_each_node(const Visit& visit) const {
    for (std::size_t r = 0; r < runs_.size(); ++r)
        for (int i = 0; i < std::min(width, density_.grid.count[0] - runs_[r][0]); ++i) visit(r, i);
}

Harmonics VisibilityErrorMetric::found_by(const VisibilitySettings& settings) const {
    const bool walks =
        settings.traversal == VisibilityTraversal::hierarchical || settings.traversal == VisibilityTraversal::full;
    if (!walks) return at_runs(field_by(settings));
    Harmonics found(runs_.size());
    const VisibilityWalk walk(device_, density_, settings, start(), progress_);
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        VisibilityWalk::Run run;
        walk(runs_[r][0], runs_[r][1], runs_[r][2], run);
        for (int c = 0; c < settings.bands * settings.bands; ++c) std::copy_n(run[c], width, found[r][c].begin());
    }
    return found;
}

Harmonics VisibilityErrorMetric::kept_by(const VisibilitySettings& settings) const {
    ShField field = field_by(settings);
    const VisibilityNodes kept = keep_nodes(device_, field, settings, progress_);
    for (std::size_t node = 0; node < field.grid.size(); ++node) {
        float steps[max_coefficients];
        kept.view().load(std::int64_t(node), steps);
        for (int c = 0; c < field.coefficients; ++c) field.node(node)[c] = steps[c] * kept.step(c);
    }
    return at_runs(field);
}

ShField VisibilityErrorMetric::field_by(const VisibilitySettings& settings) const {
    VisibilitySettings here = settings;
    here.subsample = subsample_;
    StageTimer steps;
    return find_visibility(device_, density_, here, steps, progress_);
}

Harmonics VisibilityErrorMetric::at_runs(const ShField& field) const {
    Harmonics found(runs_.size());
    for_each_node([&](std::size_t r, int i) {
        const float* node = field.node(field.grid.index(runs_[r][0] + i, runs_[r][1], runs_[r][2]));
        for (int c = 0; c < field.coefficients; ++c) found[r][c][i] = node[c];
    });
    return found;
}

double VisibilityErrorMetric::relative_error(const Harmonics& found, const Harmonics& ground_truth) const {
    double errors = 0, squares = 0;
    for_each_node([&](std::size_t r, int i) {
        for (int c = 0; c < max_coefficients; ++c) {
            errors += std::pow(found[r][c][i] - ground_truth[r][c][i], 2);
            squares += std::pow(ground_truth[r][c][i], 2);
        }
    });
    return std::sqrt(errors / squares);
}

double VisibilityErrorMetric::light_error(const Harmonics& found, const Harmonics& ground_truth,
                                          const ShLight& light) const {
    double squares = 0, count = 0;
    for_each_node([&](std::size_t r, int i) {
        for (const ShCoefficients& channel : light.coefficients) {
            double difference = 0;
            for (int c = 0; c < max_coefficients; ++c)
                difference += (found[r][c][i] - ground_truth[r][c][i]) * channel[c];
            squares += std::pow(difference / (4 * std::numbers::pi), 2), count += 1;
        }
    });
    return std::sqrt(squares / count) / ((light.mean[0] + light.mean[1] + light.mean[2]) / 3);
}

}  // namespace chiaro::bench

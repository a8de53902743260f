#include "visibility_judge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "classify/medium.h"
#include "illumination/sh/directions.h"
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

}  // namespace

VisibilityJudge::VisibilityJudge(const LitSubject& subject, int subsample, int runs, int rays, Progress& progress)
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

Harmonics VisibilityJudge::found_by(const VisibilitySettings& settings) const {
    Harmonics found(runs_.size());
    const VisibilityWalk walk(device_, density_, settings, start(), progress_);
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        VisibilityWalk::Run run;
        walk(runs_[r][0], runs_[r][1], runs_[r][2], run);
        for (int c = 0; c < settings.bands * settings.bands; ++c) std::copy_n(run[c], width, found[r][c].begin());
    }
    return found;
}

template <class Visit>
void VisibilityJudge::for_each_node(const Visit& visit) const {
    for (std::size_t r = 0; r < runs_.size(); ++r)
        for (int i = 0; i < std::min(width, density_.grid.count[0] - runs_[r][0]); ++i) visit(r, i);
}

double VisibilityJudge::relative_error(const Harmonics& found, const Harmonics& truth) const {
    double errors = 0, squares = 0;
    for_each_node([&](std::size_t r, int i) {
        for (int c = 0; c < most_coefficients; ++c) {
            errors += std::pow(found[r][c][i] - truth[r][c][i], 2);
            squares += std::pow(truth[r][c][i], 2);
        }
    });
    return std::sqrt(errors / squares);
}

double VisibilityJudge::light_error(const Harmonics& found, const Harmonics& truth,
                                    std::span<const double> light) const {
    double errors = 0, nodes = 0;
    for_each_node([&](std::size_t r, int i) {
        double difference = 0;
        for (std::size_t c = 0; c < light.size(); ++c)
            difference += (found[r][c][i] - truth[r][c][i]) * light[c] / (4 * std::numbers::pi);
        errors += difference * difference, nodes += 1;
    });
    return std::sqrt(errors / nodes);
}

}  // namespace chiaro::bench

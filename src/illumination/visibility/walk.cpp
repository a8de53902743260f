#include "illumination/visibility/walk.h"

#include <numbers>

#include "core/threads.h"
#include "illumination/sh/basis.h"
#include "illumination/sh/directions.h"
#include "illumination/visibility/launch_walk.h"

namespace chiaro {
namespace {

using kernel::LaneDirections;
using kernel::WalkStep;

constexpr double growth = 0.2;  ///< s = max(1, g t)

/// Steps of one node edge, of the finest level.
std::vector<WalkStep> even_steps(double reach) {
    std::vector<WalkStep> steps;
    for (double at = 0; at < reach; ++at) steps.push_back({float(at), 1, 0, 0});
    return steps;
}

/// s = max(1, g t), of level log2 s (the paper's), or one below: what a step meets is sharper than the step is long.
std::vector<WalkStep> growing_steps(double start, double reach, int last_level, VisibilityModel model) {
    const double below = model == VisibilityModel::paper ? 0 : 1;
    std::vector<WalkStep> steps;
    for (double at = 0; at < reach; at += steps.back().size) {
        const double size = std::max(1.0, growth * (at + start));
        const double level = std::clamp(std::log2(size) - below, 0.0, double(last_level));
        const int finer = std::min(int(level), last_level);
        steps.push_back({float(at), float(size), finer, float(level - finer)});
    }
    return steps;
}

double diagonal(const CellGrid& grid) {
    return std::hypot(double(grid.count[0]), double(grid.count[1]), double(grid.count[2]));
}

void look(const std::vector<Vec3>& directions, int lane, LaneDirections* to) {
    for (std::size_t i = 0; i < directions.size(); ++i) {
        to[i].x[lane] = float(directions[i].x);
        to[i].y[lane] = float(directions[i].y);
        to[i].z[lane] = float(directions[i].z);
    }
}

}  // namespace

VisibilityWalk::VisibilityWalk(const Device& device, const Density& density, const VisibilitySettings& settings,
                               double start, Progress& progress)
    : device_(device),
      grid_(density.grid),
      coefficients_(settings.bands * settings.bands),
      pyramid_(density, device.threads, progress) {
    const double reach = diagonal(grid_);
    const int last_level = int(pyramid_.levels().size()) - 1;
    steps_ = settings.traversal == VisibilityTraversal::full ? even_steps(reach)
                                                             : growing_steps(start, reach, last_level, settings.model);
    const auto& sampling = settings.sampling;
    for (int set = 0; sampling.jittered && set < sampling.sets; ++set)
        sets_.push_back(jittered_directions(settings.directions, set));
    if (!sampling.jittered) {
        sets_.push_back(fibonacci_directions(settings.directions));
        for_all_.resize(sets_[0].size());
        for (int lane = 0; lane < LaneDirections::width; ++lane) look(sets_[0], lane, for_all_.data());
    }
    kernel_ = {pyramid_.views().data(),
               steps_.data(),
               int(steps_.size()),
               {float(grid_.count[0]), float(grid_.count[1]), float(grid_.count[2])},
               float(start)};
}

void VisibilityWalk::operator()(int first, int y, int z, Run& harmonics) const {
    std::vector<LaneDirections> own;
    if (for_all_.empty()) {
        own.resize(sets_[0].size());
        for (int lane = 0; lane < LaneDirections::width; ++lane)
            look(sets_[scrambled(grid_.index(first + lane, y, z)) % sets_.size()], lane, own.data());
    }
    const auto& directions = own.empty() ? for_all_ : own;
    kernel::walk_for(device_.isa)(kernel_, {float(first), float(y), float(z)}, directions.data(),
                                  int(directions.size()), coefficients_, harmonics);
    const float weight = float(4 * std::numbers::pi / double(directions.size()));
    for (int c = 0; c < coefficients_; ++c)
        for (float& sum : harmonics[c]) sum *= weight;
}

ShField walk_visibility(const Device& device, const Density& density, const VisibilitySettings& settings, double start,
                        Steps& steps, Progress& progress) {
    const VisibilityWalk walk =
        steps("pyramid", [&] { return VisibilityWalk(device, density, settings, start, progress); });
    ShField field(density.grid, settings.bands * settings.bands);
    const auto [nx, ny, nz] = density.grid.count;
    const int per_row = (nx + LaneDirections::width - 1) / LaneDirections::width;
    const auto work = [&, nx = nx, ny = ny](std::int64_t run, std::int64_t) {
        const int x = int(run % per_row) * LaneDirections::width, row = int(run / per_row);
        VisibilityWalk::Run harmonics;
        walk(x, row % ny, row / ny, harmonics);
        for (int i = 0; i < std::min(LaneDirections::width, nx - x); ++i)
            for (int c = 0; c < field.coefficients; ++c)
                field.node(std::size_t(row) * std::size_t(nx) + std::size_t(x + i))[c] = harmonics[c][i];
    };
    steps("walk", [&, ny = ny, nz = nz] {
        parallel_for(device.threads, std::int64_t(per_row) * ny * nz, 1, "visibility", progress, work);
    });
    progress.check();
    return field;
}

}  // namespace chiaro

#include "illumination/visibility/walk.h"

#include <numbers>

#include "core/threads.h"
#include "illumination/sh/basis.h"
#include "illumination/sh/directions.h"
#include "illumination/visibility/launch_gpu.h"
#include "illumination/visibility/launch_walk.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

using kernel::LaneDirections;
using kernel::WalkStep;

constexpr double growth = 0.2;                    ///< s = max(1, g t)
constexpr std::int64_t nodes_together = 1 << 18;  ///< on a GPU; after which it may be cancelled

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

WalkPlan::WalkPlan(const CellGrid& nodes, const VisibilitySettings& settings, double the_start)
    : grid(nodes), start(the_start) {
    const double reach = diagonal(grid);
    const int last_level = int(pyramid_grids(grid).size()) - 1;
    steps = settings.traversal == VisibilityTraversal::full ? even_steps(reach)
                                                            : growing_steps(start, reach, last_level, settings.model);
    const auto& sampling = settings.sampling;
    for (int set = 0; sampling.jittered && set < sampling.sets; ++set)
        sets.push_back(jittered_directions(settings.directions, set));
    if (!sampling.jittered) sets.push_back(fibonacci_directions(settings.directions));
}

kernel::WalkKernel WalkPlan::kernel(const kernel::PyramidLevel* levels, const kernel::WalkStep* its_steps) const {
    return {levels,
            its_steps,
            int(steps.size()),
            {float(grid.count[0]), float(grid.count[1]), float(grid.count[2])},
            float(start)};
}

float WalkPlan::weight() const { return float(4 * std::numbers::pi / double(sets[0].size())); }

VisibilityWalk::VisibilityWalk(const Device& device, const Density& density, const VisibilitySettings& settings,
                               double start, Progress& progress)
    : device_(device),
      coefficients_(settings.bands * settings.bands),
      plan_(density.grid, settings, start),
      pyramid_(density, device.threads, progress) {
    if (settings.sampling.jittered) return;
    for_all_.resize(plan_.sets[0].size());
    for (int lane = 0; lane < LaneDirections::width; ++lane) look(plan_.sets[0], lane, for_all_.data());
}

void VisibilityWalk::operator()(int first, int y, int z, Run& harmonics) const {
    const auto& sets = plan_.sets;
    std::vector<LaneDirections> own;
    if (for_all_.empty()) {
        own.resize(sets[0].size());
        for (int lane = 0; lane < LaneDirections::width; ++lane)
            look(sets[scrambled(plan_.grid.index(first + lane, y, z)) % sets.size()], lane, own.data());
    }
    const auto& directions = own.empty() ? for_all_ : own;
    kernel::walk_for(device_.isa)(plan_.kernel(pyramid_.views().data(), plan_.steps.data()),
                                  {float(first), float(y), float(z)}, directions.data(), int(directions.size()),
                                  coefficients_, harmonics);
    for (int c = 0; c < coefficients_; ++c)
        for (float& sum : harmonics[c]) sum *= plan_.weight();
}

GpuField walk_on_gpu(const Device& device, const Density& density, const VisibilitySettings& settings, double start,
                     StageTimer& timer, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const int coefficients = settings.bands * settings.bands;
    GpuField field(device, density, coefficients);
    const GpuPyramid pyramid(device.stream, density);
    const WalkPlan plan(density.grid, settings, start);
    std::vector<kernel::Float3> directions;
    for (const auto& set : plan.sets)
        for (const Vec3 direction : set) directions.push_back(float3(direction));
    HostArrays arrays;
    arrays.add(pyramid.views()), arrays.add(plan.steps), arrays.add(directions);
    cuda::Views views(stream, std::move(arrays));
    kernel::WalkNode walk{plan.kernel(pyramid.views().data(), plan.steps.data()),
                          density.grid.count[0],
                          density.grid.count[1],
                          directions.data(),
                          int(plan.sets.size()),
                          int(plan.sets[0].size()),
                          coefficients,
                          plan.weight(),
                          field.data(),
                          0};
    views.to_device_pointers(walk.kernel.levels, walk.kernel.steps, walk.directions);
    const auto nodes = std::int64_t(density.grid.size());
    timer("walk", [&] {
        for (; walk.first < nodes; walk.first += nodes_together) {
            kernel::run_on_gpu(stream, std::min(nodes_together, nodes - walk.first), walk);
            stream.wait();
            progress.report("visibility", double(walk.first) / double(nodes));
            progress.check();
        }
    });
    return field;
}

ShField walk_visibility(const Device& device, const Density& density, const VisibilitySettings& settings, double start,
                        StageTimer& timer, Progress& progress) {
    ShField field(density.grid, settings.bands * settings.bands);
    const auto on_gpu = [&] { walk_on_gpu(device, density, settings, start, timer, progress).fetch(field); };
    if (cuda::try_gpu(device, on_gpu)) return field;
    const VisibilityWalk walk =
        timer("pyramid", [&] { return VisibilityWalk(device, density, settings, start, progress); });
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
    timer("walk", [&, ny = ny, nz = nz] {
        parallel_for(device.threads, std::int64_t(per_row) * ny * nz, 1, "visibility", progress, work);
    });
    progress.check();
    return field;
}

}  // namespace chiaro

#include "illumination/visibility/visibility.h"

#include <optional>

#include "illumination/sh/directions.h"
#include "illumination/visibility/sweep.h"
#include "illumination/visibility/walk.h"

namespace chiaro {
namespace {

/// One set: a sweep takes all nodes together.
std::vector<Vec3> directions_of(const VisibilitySettings& settings) {
    return settings.sampling.jittered ? jittered_directions(settings.directions, 0)
                                      : fibonacci_directions(settings.directions);
}

bool is_walk(const VisibilitySettings& settings) {
    return settings.traversal == VisibilityTraversal::hierarchical || settings.traversal == VisibilityTraversal::full;
}

/// By rays or by sweeps: walk_visibility and sweep_visibility, or those whose field stays on the GPU.
template <class Walk, class Sweep>
auto traverse(const Walk& walk, const Sweep& sweep, const Device& device, const Density& density,
              const VisibilitySettings& settings, StageTimer& timer, Progress& progress) {
    const double start = 0.5 / settings.subsample;
    if (is_walk(settings)) return walk(device, density, settings, start, timer, progress);
    return timer("visibility", [&] {
        return sweep(device, density, directions_of(settings), settings.bands * settings.bands, start,
                     lattice_of(settings.traversal), progress);
    });
}

}  // namespace

VisibilityNodes visibility_nodes(const Device& device, std::shared_ptr<const Density> density,
                                 const VisibilitySettings& settings, StageTimer& timer, Progress& progress) {
    std::optional<VisibilityNodes> nodes;
    const auto on_gpu = [&] {
        const GpuField field = traverse(walk_on_gpu, sweep_on_gpu, device, *density, settings, timer, progress);
        nodes.emplace(timer("keep", [&] { return field.keep(settings); }));
    };
    if (!cuda::try_gpu(device, on_gpu)) {
        const ShField field = find_visibility(device, *density, settings, timer, progress);
        nodes.emplace(timer("keep", [&] { return keep_nodes(device, field, settings, progress); }));
    }
    nodes->density = std::move(density);
    return *std::move(nodes);
}

ShField find_visibility(const Device& device, const Density& density, const VisibilitySettings& settings,
                        StageTimer& timer, Progress& progress) {
    return traverse(walk_visibility, sweep_visibility, device, density, settings, timer, progress);
}

void refine_visibility(const Device& device, const Medium::Data& medium, const VisibilitySettings& settings,
                       const std::function<void(VisibilityNodes, bool is_coarse)>& keep, StageTimer& timer,
                       Progress& progress) {
    std::vector<std::shared_ptr<const Density>> densities;  // from fine to coarse
    const auto add = [&](Density density) { densities.push_back(std::make_shared<const Density>(std::move(density))); };
    add(timer("density", [&] { return density_for(medium, settings.subsample, device, progress); }));
    for (int f = settings.subsample; f < 8; f *= 2) add(halved(*densities.back(), device, progress));
    for (int level = int(densities.size()) - 1; level >= 0; --level) {
        VisibilitySettings coarse = settings;
        coarse.subsample = settings.subsample << level;
        coarse.directions = std::max(settings.directions >> level, std::min(settings.directions, 64));
        keep(visibility_nodes(device, densities[std::size_t(level)], coarse, timer, progress), level > 0);
    }
}

}  // namespace chiaro

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

/// V starts so many node edges from a node.
double start_of(const VisibilitySettings& settings) { return 0.5 / settings.subsample; }

/// By sweep_visibility or another that is asked the same.
template <class Sweep>
auto swept_by(const Sweep& sweep, const Device& device, const Density& density, const VisibilitySettings& settings,
              StageTimer& timer, Progress& progress) {
    return timer("visibility", [&] {
        return sweep(device, density, directions_of(settings), settings.bands * settings.bands, start_of(settings),
                     lattice_of(settings.traversal), progress);
    });
}

}  // namespace

VisibilityNodes visibility_nodes(const Device& device, std::shared_ptr<const Density> density,
                                 const VisibilitySettings& settings, StageTimer& timer, Progress& progress) {
    std::optional<VisibilityNodes> nodes;
    const bool in_steps = !is_walk(settings) && settings.storage == ShStorage::u8;
    const auto keep = [&](auto field) {
        nodes.emplace(timer("keep", [&] { return keep_nodes(device, std::move(field), settings, progress); }));
    };
    const auto on_gpu = [&] {
        const auto sweep = [&](auto&&... asked) { return sweep_on_gpu(asked..., in_steps); };
        const GpuField field = is_walk(settings)
                                   ? walk_on_gpu(device, *density, settings, start_of(settings), timer, progress)
                                   : swept_by(sweep, device, *density, settings, timer, progress);
        nodes.emplace(timer("keep", [&] { return field.keep(settings); }));
    };
    if (!cuda::try_gpu(device, on_gpu)) {
        if (in_steps)
            keep(swept_by(sweep_in_steps, device, *density, settings, timer, progress));
        else
            keep(find_visibility(device, *density, settings, timer, progress));
    }
    nodes->density = std::move(density);
    return *std::move(nodes);
}

ShField find_visibility(const Device& device, const Density& density, const VisibilitySettings& settings,
                        StageTimer& timer, Progress& progress) {
    if (is_walk(settings)) return walk_visibility(device, density, settings, start_of(settings), timer, progress);
    return swept_by(sweep_visibility, device, density, settings, timer, progress);
}

bool refine_visibility(const Device& device, const Medium::Data& medium, const VisibilitySettings& settings,
                       const VisibilityNodes* before, const std::function<void(VisibilityNodes, bool is_coarse)>& keep,
                       StageTimer& timer, Progress& progress) {
    std::vector<std::shared_ptr<const Density>> densities;  // from fine to coarse
    const auto add = [&](Density density) { densities.push_back(std::make_shared<const Density>(std::move(density))); };
    add(timer("density", [&] { return density_for(medium, settings.subsample, device, progress); }));
    if (before && before->density && is_same(*before->density, *densities.front())) return true;
    for (int f = settings.subsample; f < 8; f *= 2) add(halved(*densities.back(), device, progress));
    for (int level = int(densities.size()) - 1; level >= 0; --level) {
        VisibilitySettings coarse = settings;
        coarse.subsample = settings.subsample << level;
        coarse.directions = std::max(settings.directions >> level, std::min(settings.directions, 64));
        keep(visibility_nodes(device, densities[std::size_t(level)], coarse, timer, progress), level > 0);
    }
    return false;
}

}  // namespace chiaro

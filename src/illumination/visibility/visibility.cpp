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

/// By rays or by sweeps: walk_visibility and sweep_visibility, or those whose field stays on the card.
template <class Walk, class Sweep>
auto traverse(const Walk& walk, const Sweep& sweep, const Device& device, const Density& density,
              const VisibilitySettings& settings, Steps& steps, Progress& progress) {
    const double start = 0.5 / settings.subsample;
    if (is_walk(settings)) return walk(device, density, settings, start, steps, progress);
    return steps("visibility", [&] {
        return sweep(device, density, directions_of(settings), settings.bands * settings.bands, start,
                     lattice_of(settings.traversal), progress);
    });
}

/// As `settings` are kept, as `found` is found.
VisibilityNodes nodes_of(const Device& device, const Density& density, const VisibilitySettings& found,
                         const VisibilitySettings& settings, Steps& steps, Progress& progress) {
    std::optional<VisibilityNodes> nodes;
    const auto on_card = [&] {
        const CardField field = traverse(walk_on_card, sweep_on_card, device, density, found, steps, progress);
        nodes.emplace(steps("keep", [&] { return field.keep(settings); }));
    };
    if (cuda::done_on_card(device, on_card)) return *std::move(nodes);
    const ShField field = find_visibility(device, density, found, steps, progress);
    return steps("keep", [&] { return keep_nodes(device, field, density, settings, progress); });
}

}  // namespace

ShField find_visibility(const Device& device, const Density& density, const VisibilitySettings& settings, Steps& steps,
                        Progress& progress) {
    return traverse(walk_visibility, sweep_visibility, device, density, settings, steps, progress);
}

void refine_visibility(const Device& device, const Medium::Data& medium, const VisibilitySettings& settings,
                       const std::function<void(VisibilityNodes, bool is_coarse)>& keep, Steps& steps,
                       Progress& progress) {
    std::vector<Density> densities;  // from fine to coarse
    densities.push_back(steps("density", [&] { return density_for(medium, settings.subsample, device, progress); }));
    for (int f = settings.subsample; f < 8; f *= 2) densities.push_back(halved(densities.back(), device, progress));
    for (int level = int(densities.size()) - 1; level >= 0; --level) {
        VisibilitySettings coarse = settings;
        coarse.subsample = settings.subsample << level;
        coarse.directions = std::max(settings.directions >> level, std::min(settings.directions, 64));
        const Density& density = densities[std::size_t(level)];
        keep(nodes_of(device, density, coarse, settings, steps, progress), level > 0);
    }
}

}  // namespace chiaro

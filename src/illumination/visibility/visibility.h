// Visibility in spherical harmonics, whichever way it is found.
#pragma once
#include "illumination/visibility/nodes.h"

#include "illumination/stage_timer.h"

namespace chiaro {

/// V_lm at the nodes of a density, which stand for `settings.subsample`³ cells, in the axes of the grid; V starts half
/// a cell edge from a node.
ShField find_visibility(const Device& device, const Density& density, const VisibilitySettings& settings,
                        StageTimer& timer, Progress& progress);

/// The same as it is kept.
VisibilityNodes visibility_nodes(const Device& device, std::shared_ptr<const Density> density,
                                 const VisibilitySettings& settings, StageTimer& timer, Progress& progress);

/// Hands the nodes of a coarse field to `keep` at once, then those of finer ones, the last as the settings ask for:
/// every 8th cell, 4th ..., the coarse ones with fewer directions (some 5 % of the last one's time in all). None where
/// those `before`, found as the settings ask for, are of the same density: returns whether they are. Throws
/// Error{interrupted}.
bool refine_visibility(const Device& device, const Medium::Data& medium, const VisibilitySettings& settings,
                       const VisibilityNodes* before, const std::function<void(VisibilityNodes, bool is_coarse)>& keep,
                       StageTimer& timer, Progress& progress);

}  // namespace chiaro

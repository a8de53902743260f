// One value of each ray, or a sum along it, of which ranks that share a volume hold parts.
#pragma once
#include "raycast/views.h"

namespace chiaro {

/// Whether rays through a block find parts of such values, which no blend of frames puts together.
inline bool shares_values(const Medium::Data& medium) {
    return medium.volume.data().placement && !is_lit(medium.shape.mode);
}

/// Finds the rank's own parts of values: kernel::ValueKernel's. Not of Mode::additive, whose parts are colours.
RenderStatistics cast_values(const Device& device, const Medium::Data& medium, const RayTables& tables,
                             const Camera& camera, const RaySettings& settings, Frame& frame, Progress& progress);

/// Collective: what the ranks found becomes the whole picture, on every rank.
void join_values(const Device& device, const Medium::Data& medium, const RayTables& tables, Frame& frame);

}  // namespace chiaro

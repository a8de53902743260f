// Accessibility as a picture needs it. A cell of an opaque surface is half buried in it, the one above it is open: so
// the field is looked up one edge along the outward normal n, and scaled so that an open flat surface keeps its
// brightness: A'(x) = min(1, (2 A / (1 + q))(x + n)), q = min(1, 4 F |n|) the share of the answer that looks outwards
// only. n = -(α(i + 1) - α(i - 1)) per axis, shortened to 1. The ray caster then needs a single look-up.
#pragma once
#include <chiaro/device.h>
#include <chiaro/progress.h>

#include "illumination/cells/opacity.h"

namespace chiaro {

/// Only the given blocks are filled. `normal_factor` is F. Cost: 27 neighbours a cell; a fifth of a
/// whole update.
CellValues normal_offset_off_surfaces(const Device& device, const CellValues& access, const CellValues& opacity,
                                      double normal_factor, const BlockMap& blocks, Progress& progress);

/// The same in parts, into `out`: what lifts at most 32 slices of a column of blocks, the first a multiple of 4, by one
/// thread. All that is named must stay where it is.
SliceWork slice_lifter(const Device& device, const CellRows& access, const CellRows& opacity, double normal_factor,
                       const BlockMap& blocks, CellValues& out);

}  // namespace chiaro

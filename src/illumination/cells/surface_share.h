// Accessibility as pictures of surfaces read it. Over an open flat surface a cell that looks all around sees half of
// everything, one that looks outwards only sees all: A / (1 + q) is ½ of either, q = min(1, 4 F |n|) the share of the
// answer that looks outwards. The ray caster reads it off the surface, by the sample's own normal (field.h).
#pragma once
#include <chiaro/device.h>
#include <chiaro/progress.h>

#include "illumination/cells/opacity.h"

namespace chiaro {

/// Cells off a surface where it is read; with the depth of a sample in its skin at most so many; and so far from what
/// is seen cells are read then. Pictures under white of a bonsai, two brains, engine, menger and tubes against paths of
/// light: of 1 to 2 cells, 2 to 3.5 at most, these have the least error with which no ball shows its grid (.4 % RMS
/// with 1 cell, .14 with 1.5: as without light).
inline constexpr double access_lift = 1.5, max_access_lift = 2.5, access_reach = max_access_lift + 1;

/// A / (1 + q) in the place of A, in the given blocks. `normal_factor` is F. For methods that do not do so themselves.
CellValues surface_shares(const Device& device, CellValues access, const CellValues& opacity, double normal_factor,
                          const BlockMap& blocks, Progress& progress);

}  // namespace chiaro

// Accessibility as pictures of surfaces read it. Over an open flat surface a cell that looks all around sees half of
// everything, one that looks outwards only sees all: A / (1 + q) is ½ of either, q = min(1, 4 F |n|) the share of the
// answer that looks outwards. The ray caster reads it off the surface, by the sample's own normal (field.h).
#pragma once
#include <chiaro/device.h>
#include <chiaro/progress.h>

#include "illumination/cells/opacity.h"

namespace chiaro {

/// Cells off a sample of a surface where it is read, and how far from what is seen cells are read then. Tuned on
/// pictures under white of a bonsai, two brains, engine, menger and tubes against paths of light, and on balls: nearer,
/// a ball of hard edges shows more of its grid; with the sample's depth in its skin beside it flat walls in a box have
/// rings; and farther off furrows are too bright.
inline constexpr double access_lift = 2, access_reach = access_lift + 1;

/// A / (1 + q) in the place of A, in the given blocks. `normal_factor` is F. For methods that do not do so themselves.
CellValues surface_shares(const Device& device, CellValues access, const CellValues& opacity, double normal_factor,
                          const BlockMap& blocks, Progress& progress);

}  // namespace chiaro

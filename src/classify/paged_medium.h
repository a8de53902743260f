// The medium of a level that is read by bricks.
#pragma once
#include "classify/medium.h"
#include "volume/exact_ranges.h"
#include "volume/paged_level.h"

namespace chiaro {

/// A medium of the level that looks as `whole` does, the medium of the volume that stands for absent bricks; the level
/// is classified for it. Bricks are taken for empty, and never asked for, where `exact` (of level 0) says so; of other
/// levels, or without it, where `whole` has nothing visible within a cell of it. Cost: one look at the table's bricks,
/// and at the cells of those that are there. Light of `whole` is read by it (raycast).
Medium paged_medium(PagedLevel& level, const Medium& whole, const BrickRanges* exact = nullptr);

}  // namespace chiaro

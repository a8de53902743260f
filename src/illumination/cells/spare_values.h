// Memory of a grid's values that is kept from edit to edit.
#pragma once
#include "illumination/cells/grid.h"

namespace chiaro {

/// Values of which the pieces of `written` are going to be written, all of them; elsewhere 0. Their memory may be that
/// of values made so for the same grid that went, of which the process keeps those of two grids.
CellValues values_to_write(const CellGrid& grid, const BlockMap& written, bool use_small_pages, int threads);

}  // namespace chiaro

// Cells that a surface leaves mostly open: walls begin within half a cell of where they are.
#pragma once
#include "illumination/transport/grid.h"

namespace chiaro {

/// Cells of optical thickness 2 or more that hard matter (1 or more deep over a voxel) fills by at most half, before a
/// cell that it fills by more: what is left of them is fog of depth -ln(1 - fill), through which light reaches the cell
/// behind. Any thickness would otherwise count as a cell's: a wall's face stood up to a cell too far out, and what
/// pictures read there were the light of its far side. A cell between two rooms stays as it is, so that walls
/// of a cell or less let nothing through: its clear neighbours must hang together and touch all such cells around.
/// Returns them. Cost: 8 or 72 look-ups for each node on a surface.
std::vector<std::size_t> open_boundary_cells(const Medium::Data& medium, const Device& device, Progress& progress,
                                             Density& extinction);

}  // namespace chiaro

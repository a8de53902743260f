// How much light one cell stops: what every method that filters opacity starts from.
#pragma once
#include <chiaro/progress.h>

#include "illumination/cells/grid.h"

namespace chiaro {

struct CellOpacity {
    CellValues values;
    BlockMap matter;              ///< blocks that may hold something else than 0
    BlockMap visible{{0, 0, 0}};  ///< within a cell of which a ray may see something
};

/// α of one cell edge at the cells' centres, α = 1 - exp(-κ e): the volume classified there (interpolated first where
/// cells are not voxels); 0 where it is clipped away. Of isosurfaces, how much of the cell lies inside:
/// α = clamp(½ + (f - iso) / (|∇f| e), 0, 1), times the surface's opacity. Cost: one look-up a cell near matter.
/// Throws Error{interrupted} when cancelled.
CellOpacity cell_opacity(const Device& device, const Medium::Data& medium, Progress& progress);
/// The same by the volume's device.
CellOpacity cell_opacity(const Medium::Data& medium, Progress& progress);

/// The same in parts: the grid and what of it is asked for, all opacities 0 yet; and what fills slices of a column of
/// blocks where they are held by `matter`, by one thread. `out` must stay where it is.
CellOpacity no_opacity_yet(const Medium::Data& medium);
SliceWork opacity_filler(const Medium::Data& medium, CellOpacity& out);

/// Extinction per cell edge of entry j of the optical table: the same quantity unrounded.
std::vector<float> extinction_per_edge(const Medium::Data& medium, const CellGrid& grid);

}  // namespace chiaro

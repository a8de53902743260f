// How much light one cell stops: what every method that filters opacity starts from.
#pragma once
#include <chiaro/progress.h>

#include "illumination/cells/slices.h"

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

/// What of a grid is asked for.
struct OpacityMaps {
    CellGrid grid;
    BlockMap matter, visible;  ///< as above
};
OpacityMaps opacity_maps(const Medium::Data& medium);
/// The same in parts: what fills slices of a column of blocks where they are held by `maps.matter`, by one thread.
/// Elsewhere it writes 0 where `to` holds some slices only, which held others before. `maps` must stay where they are.
SliceWork opacity_filler(const Medium::Data& medium, const OpacityMaps& maps, const RowsOf<std::uint16_t>& to);

/// Extinction per cell edge of entry j of the optical table: the same quantity unrounded.
std::vector<float> extinction_per_edge(const Medium::Data& medium, const CellGrid& grid);

}  // namespace chiaro

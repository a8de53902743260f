// The methods that answer with one number: the share of light that reaches a cell.
#pragma once
#include <chiaro/device.h>
#include <chiaro/error.h>
#include <chiaro/lighting.h>

#include "illumination/cells/field.h"
#include "illumination/cells/opacity.h"
#include "illumination/stage_timer.h"

namespace chiaro {

/// The accessibility A of every cell of the given blocks, 1 = open. `of_surfaces`: A / (1 + q), as pictures of surfaces
/// read it (cells/surface_share.h).
CellValues accessibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                         const IlluminationSettings& settings, const BlockMap& blocks, StageTimer& timer,
                         Progress& progress, bool of_surfaces = false);

/// How that is read; a cell is so many of a voxel's smallest edges wide.
kernel::SurfaceAccess surface_access(const IlluminationSettings& settings, double cell_edges);

/// A of every voxel of the volume, on its own grid and geometry.
Volume accessibility_of_voxels(const Device& device, const Medium::Data& medium, const IlluminationSettings& settings,
                               StageTimer& timer, Progress& progress);

/// What the method computes for every voxel (see compute_field).
Volume field_of_voxels(const Device& device, const Medium::Data& medium, const Prepared& prepared,
                       const IlluminationSettings& settings, StageTimer& timer, Progress& progress);

}  // namespace chiaro

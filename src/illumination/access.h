// The methods that answer with one number: the share of light that reaches a cell.
#pragma once
#include <chiaro/device.h>
#include <chiaro/error.h>
#include <chiaro/lighting.h>

#include "illumination/cells/opacity.h"
#include "illumination/stage_timer.h"

namespace chiaro {

/// The accessibility of every cell of the given blocks, 1 = open, neither shifted nor scaled.
CellValues accessibility(const Device& device, const Medium::Data& medium, const CellOpacity& opacity,
                         const IlluminationSettings& settings, const BlockMap& blocks, StageTimer& timer,
                         Progress& progress);

/// The same for every voxel of the volume, on its own grid and geometry.
Volume accessibility_of_voxels(const Device& device, const Medium::Data& medium, const IlluminationSettings& settings,
                               StageTimer& timer, Progress& progress);

/// What the method computes for every voxel (see compute_field).
Volume field_of_voxels(const Device& device, const Medium::Data& medium, const Prepared& prepared,
                       const IlluminationSettings& settings, StageTimer& timer, Progress& progress);

/// F of `normal_offset_off_surfaces`: how soon a normal makes the answer look outwards only; 0 when it never does.
double outward_factor(const IlluminationSettings& settings);

}  // namespace chiaro

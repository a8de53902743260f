// The fused sweep for a picture, layer by layer of blocks: of opacities, of the finest corners and of accessibility
// only what the layer at work reads is held, and so little more than the answer. Opacities are found twice: for the
// coarser grids, and again for the cells.
#pragma once
#include <chiaro/lighting.h>

#include "illumination/cells/opacity.h"
#include "illumination/stage_timer.h"

namespace chiaro {

/// What a picture reads: the same numbers as of cell_opacity, spao_accessibility and normal_offset_off_surfaces one
/// after the other, where a ray may see something; elsewhere 0. For settings that are fused (spao.h), and on the host.
/// Memory beyond the answer's two bytes a cell: three layers of blocks, and half a byte a cell for the coarser grids,
/// given back from layer to layer.
CellValues spao_light(const Device& device, const Medium::Data& medium, const SpaoSettings& settings,
                      double normal_factor, StageTimer& timer, Progress& progress);

}  // namespace chiaro

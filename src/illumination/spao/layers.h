// The fused sweep for a picture, layer by layer of blocks: of opacities, of the finest corners and of accessibility
// only what the layer at work reads is held, and so little more than the answer. Opacities are found twice: for the
// coarser grids, and again for the cells.
#pragma once
#include <chiaro/lighting.h>

#include "illumination/cells/opacity.h"
#include "illumination/stage_timer.h"

namespace chiaro {

/// What a picture of surfaces reads: the same numbers as of cell_opacity and spao_accessibility one after the other,
/// where samples read them; elsewhere 0. For settings that are fused (spao.h), and on the host.
/// Memory beyond the answer's two bytes a cell: three layers of blocks, and half a byte a cell for the coarser grids,
/// given back from layer to layer.
CellValues spao_light(const Device& device, const Medium::Data& medium, const SpaoSettings& settings, StageTimer& timer,
                      Progress& progress);

}  // namespace chiaro

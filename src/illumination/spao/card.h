// SPAO on a card: opacities go there once, all levels and grids stay there, the answer comes back.
#pragma once
#include "cuda/stream.h"
#include "illumination/access.h"

namespace chiaro {

/// As fused_sweep on the device's card. Memory there: 4 bytes a cell, what fused_sweep keeps, 72 MB of tiles.
CellValues fused_on_card(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                         const BlockMap& blocks, Steps& steps, Progress& progress);

/// Of stored levels, the first `mip_levels` of them mipmaps. Memory there: 4 bytes a cell, and what SpaoLevels keeps.
CellValues stored_on_card(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                          int mip_levels, const BlockMap& blocks, Steps& steps, Progress& progress);

}  // namespace chiaro

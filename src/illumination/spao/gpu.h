// SPAO on a GPU: from opacities there, by levels and coarser grids that are made there; the answer stays.
#pragma once
#include "cuda/stream.h"
#include "illumination/access.h"

namespace chiaro {

/// As fused_sweep on the device's GPU. Memory there: 6 bytes a cell, what fused_sweep keeps of coarser grids, 72 MB of
/// tiles.
CellValues fused_on_gpu(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                        const BlockMap& blocks, StageTimer& timer, Progress& progress, bool of_surfaces);

/// Of stored levels, the first `mip_levels` of them mipmaps. Memory there: 6 bytes a cell, and what SpaoLevels keeps.
CellValues stored_on_gpu(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings, int mip_levels,
                         const BlockMap& blocks, StageTimer& timer, Progress& progress);

/// Of exact sums. Memory there: 14 bytes a cell.
CellValues exact_on_gpu(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                        const BlockMap& blocks, StageTimer& timer, Progress& progress);

}  // namespace chiaro

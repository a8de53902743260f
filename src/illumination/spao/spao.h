// Smooth probabilistic ambient occlusion (Kroes, Schut and Eisemann, GPU Zen): means of opacity over growing cubes.
#pragma once
#include "illumination/access.h"

namespace chiaro {

/// Whether the fused sweep does it: no look-up moves with the normal, and no filter is asked for by name.
bool is_fused(const SpaoSettings& settings);

/// Fills the cells of the given blocks. `of_surfaces`: A / (1 + q) (cells/surface_share.h), of the fused sweep only.
CellValues spao_accessibility(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                              const BlockMap& blocks, StageTimer& timer, Progress& progress, bool of_surfaces = false);

}  // namespace chiaro

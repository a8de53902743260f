// The fused sweep: no level is kept. Shells 0 and 1 are found block by block in the cache; shell l >= 2 at the corners
// of cells 2^(l-1) as wide, where its octants are whole cells, joined to all further ones, and then interpolated.
#pragma once
#include "illumination/access.h"
#include "illumination/spao/kernel.h"
#include "illumination/spao/levels.h"

namespace chiaro {

/// How many grids are coarser than the cells.
inline int coarse_grids(const SpaoSettings& settings) {
    return std::max(0, settings.levels - kernel::SpaoTile::shells);
}
inline int octants_of(SpaoModel model) { return model == SpaoModel::corrected ? 8 : 1; }
/// What is the same for all blocks of a grid. `of_surfaces`: as of fused_sweep; `goes_on`: another grid is coarser.
kernel::SpaoBlock spao_block(const SpaoSettings& settings, bool of_surfaces, bool goes_on);
inline std::string name_of_cells(int grid) { return "spao cells of " + std::to_string(1 << grid); }

kernel::SpaoTile& tile_of_thread();
/// Where the cells of a block go.
kernel::SpaoOutput output_of_cells(const RowsOf<std::uint16_t>& access, const BlockMap& blocks, std::size_t block);

/// Fills the cells of the given blocks; `settings` ask for no look-up that moves with the normal. Memory: two bytes a
/// cell for the result, .6 for coarser opacities and weights, 2.3 for what the coarser grids find out near what is
/// seen. `of_surfaces`: A / (1 + q) (cells/surface_share.h).
CellValues fused_sweep(const Device& device, const CellOpacity& opacity, const SpaoSettings& settings,
                       const BlockMap& blocks, StageTimer& timer, Progress& progress, bool of_surfaces = false);

}  // namespace chiaro

// The optical depth of a cell whose value changes within it.
#pragma once
#include <functional>

#include "illumination/cells/block_place.h"
#include "illumination/cells/opacity.h"

namespace chiaro {

struct Density;

/// 32³ floats, x fastest: one block of cells.
inline constexpr int tile_size = block_edge * block_edge * block_edge;

/// Fills a tile, all 0 before, with the optical depth of the edges of a block's cells.
using FillBlock = std::function<void(std::size_t block, float* tile)>;
/// The same on a GPU: tiles of blocks side by side, which may hold anything before.
using FillBlocks = std::function<void(const kernel::BlockPlace* places, std::int64_t blocks, float* tiles)>;

struct BlockDepths {
    FillBlock here;
    std::function<FillBlocks(cuda::Stream&)> on_gpu;
};

/// κ = (τx + τy + τz) / 3, τ_a the optical depth across the cell along axis a, the value piecewise linear between the
/// centres of neighbouring cells (beyond the volume it goes on as it is at the border, though nothing lies there):
/// what the transfer function holds between two voxels is met, however thin (Ritschel 2007, level 0, whose expected
/// transparency is exp(-κ)). 0 where a cell's centre is clipped away. `matter`: the pieces within a cell of something
/// visible. All must outlive the function. Cost: seven values and six look-ups a cell near matter.
BlockDepths block_depths(const Medium::Data& medium, const CellGrid& grid, const BlockMap& matter);

/// κ = -ln(1 - α) of cells classified as points.
BlockDepths block_depths(const CellOpacity& opacity);

/// κ of nodes as they are; `all`: of all blocks.
BlockDepths block_depths(const Density& density, const BlockMap& all);

}  // namespace chiaro

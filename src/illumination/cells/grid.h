// Cubic cells of the smallest spacing over the volume's whole voxels. Light is computed on them, so that cubes, balls
// and distances are what they are in millimetres whatever the voxels' shape (cells are the voxels where these are
// cubes).
#pragma once
#include <chiaro/medium.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include "illumination/cells/cell_kernel.h"
#include "illumination/cells/mirrored_buffer.h"
#include "illumination/cells/place.h"

namespace chiaro {

struct CellGrid {
    std::array<int, 3> count{0, 0, 0};
    double edge_mm = 1;
    Vec3 voxels_per_cell{1, 1, 1};
    bool is_voxel_grid = true;

    std::size_t size() const { return std::size_t(count[0]) * count[1] * count[2]; }
    std::size_t index(int x, int y, int z) const { return (std::size_t(z) * count[1] + y) * count[0] + x; }
    bool holds(int x, int y, int z) const {
        return x >= 0 && y >= 0 && z >= 0 && x < count[0] && y < count[1] && z < count[2];
    }
    /// Voxel coordinates of a cell's centre; cells and voxels both cover [-½, n - ½] of their index.
    Vec3 voxel_of(double x, double y, double z) const {
        return {(x + 0.5) * voxels_per_cell.x - 0.5, (y + 0.5) * voxels_per_cell.y - 0.5,
                (z + 0.5) * voxels_per_cell.z - 0.5};
    }
};

/// One cell for `factor`³ of them, at the centre of each such block; those of the last may lie outside.
CellGrid coarser(const CellGrid& grid, int factor);

/// Where the cells lie in the world.
Geometry geometry_of(const CellGrid& cells, const Geometry& voxels);

kernel::GridView view_of(const CellGrid& grid);

/// The grid's cells among the voxels, none clipped; then those of a medium.
kernel::CellCentres cell_centres(const CellGrid& grid);
kernel::CellCentres cell_centres(const Medium::Data& medium, const CellGrid& grid);

/// Of the smallest spacing, or wider where that would make more than 64 cells a voxel, or 2^28 and more cells
/// than voxels.
CellGrid make_cell_grid(const std::array<int, 3>& dimensions, const Geometry& geometry);

inline constexpr float cell_one = 65535;
inline std::uint16_t cell_value(double share) { return kernel::share_value(share); }

/// One number in [0, 1] for every cell, as 65535ths; x fastest. What was never written takes no memory and reads as 0.
/// What a GPU made stays there until the host reads it.
struct CellValues {
    CellGrid grid;
    MirroredBuffer buffer;

    explicit CellValues(const CellGrid& cells) : CellValues(cells, VoxelBuffer(bytes_of(cells))) {}
    /// In memory of so many bytes.
    CellValues(const CellGrid& cells, VoxelBuffer memory) : grid(cells), buffer(std::move(memory)) {}
    static std::size_t bytes_of(const CellGrid& cells) { return (cells.size() + spare) * sizeof(std::uint16_t); }
    std::uint16_t* data() { return reinterpret_cast<std::uint16_t*>(buffer.data()); }
    const std::uint16_t* data() const { return reinterpret_cast<const std::uint16_t*>(buffer.data()); }
    const std::uint16_t* address() const { return reinterpret_cast<const std::uint16_t*>(buffer.address()); }
    const std::uint16_t* on_gpu(cuda::Stream& stream) const {
        return reinterpret_cast<const std::uint16_t*>(buffer.on_gpu(stream));
    }

    static constexpr std::size_t spare = 8;  ///< look-ups read two cells at a time
};

/// Blocks of cells, over which work is shared out and empty space is left out.
inline constexpr int block_edge = 32;

/// Pieces of a block, 16 × 4 × 4 cells each: bit x of [z][y].
struct BlockPieces {
    static constexpr int width = 16, height = 4;
    std::uint8_t bits[block_edge / height][block_edge / height];
};
inline constexpr BlockPieces all_pieces = [] {
    BlockPieces all{};
    for (auto& slice : all.bits)
        for (auto& row : slice) row = 3;
    return all;
}();

struct BlockMap {
    std::array<int, 3> count{0, 0, 0};
    std::vector<std::uint8_t> holds;  ///< x fastest
    std::vector<BlockPieces> pieces;  ///< of each block; empty: all of those that are held

    explicit BlockMap(const std::array<int, 3>& cells, bool all = false)
        : count{blocks(cells[0]), blocks(cells[1]), blocks(cells[2])},
          holds(std::size_t(count[0]) * count[1] * count[2], all) {}
    std::array<int, 3> at(std::size_t block) const {
        return {int(block % count[0]), int(block / count[0] % count[1]), int(block / count[0] / count[1])};
    }
    std::uint8_t& operator()(int x, int y, int z) { return holds[(std::size_t(z) * count[1] + y) * count[0] + x]; }
    std::size_t index(int x, int y, int z) const { return (std::size_t(z) * count[1] + y) * count[0] + x; }
    const BlockPieces& pieces_of(std::size_t block) const { return pieces.empty() ? all_pieces : pieces[block]; }
    /// Of at most 32 slices of a column of blocks, the first a multiple of 4 that may lie within a block.
    BlockPieces pieces_of_slices(std::array<int, 2> column, int first, int end) const;
    bool at(int x, int y, int z) const { return holds[(std::size_t(z) * count[1] + y) * count[0] + x]; }
    bool any_in_row(int y, int z) const {
        const auto row = holds.begin() + std::ptrdiff_t((std::size_t(z) * count[1] + y) * count[0]);
        return std::any_of(row, row + count[0], [](std::uint8_t held) { return held != 0; });
    }
    /// First cell and end of a block, within the grid.
    std::array<std::pair<int, int>, 3> cells(std::size_t block, const std::array<int, 3>& grid) const;
    std::vector<std::size_t> held() const;                                ///< the blocks that are set, in order
    std::vector<std::size_t> held(int first_layer, int end_layer) const;  ///< of layers along z
    /// The columns of which a block that holds slices [first, end) of cells is set.
    std::vector<std::array<int, 2>> columns(int first, int end) const;

private:
    static int blocks(int cells) { return (cells + block_edge - 1) / block_edge; }
};

/// Work on slices [first, end) of cells of a column of blocks (x, y).
using SliceWork = std::function<void(std::array<int, 2> column, int first, int end)>;

/// The blocks, and pieces of them, within `reach` cells of which a ray may see something.
BlockMap visible_blocks(const Medium::Data& medium, const CellGrid& grid, double reach);

}  // namespace chiaro

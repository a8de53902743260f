// The same kernels as a GPU's threads call them: a cell each, of a whole grid or of many blocks side by side.
#pragma once
#include "illumination/cells/block_place.h"
#include "illumination/spao/kernel.h"
#include "illumination/spao/levels.h"
#include "illumination/spao/sums.h"

namespace chiaro::kernel {

/// Where the cells of a grid go: x next to each other.
struct GridTarget {
    std::uint16_t* to;
    std::int32_t row, slice;
    std::int32_t count[3];
};

/// Blocks whose tiles are in memory at the same time.
struct SpaoBatch {
    const BlockPlace* places;
    SpaoTile* tiles;
    OpacityGrid opacity;
    SpaoBlock block;        ///< but for its tile; `weight` from the grid's first corner on
    CoarseCorners coarse;   ///< where it goes on
    GridTarget to;          ///< the whole grid; null: to `octants`
    EightOctants* octants;  ///< of the grid's corners

    /// The opacity of item i of [0, SpaoTile::size) of each block; beyond the grid nothing.
    CHIARO_INLINE void load(std::int64_t item) const {
        const BlockItem<SpaoTile::row, SpaoTile::halo, SpaoTile::size> its(places, item);
        tiles[its.block].opacity[its.i] = opacity.at(its.grid_x(), its.grid_y(), its.grid_z());
    }
    /// Its means: of level 1; of level 2, from those; on a coarser grid, where that is all, from opacities.
    CHIARO_INLINE void find_mean(std::int64_t item, int level, bool from_means) const {
        const std::int32_t i = std::int32_t(item % SpaoTile::size);
        if (i >= SpaoTile::size - SpaoTile::slice - SpaoTile::row - 1) return;  // none looks there
        SpaoTile& tile = tiles[item / SpaoTile::size];
        tile.mean[level - 1][i] = halved((from_means ? tile.mean[0] : tile.opacity) + i);
    }
    /// Item i of [0, BlockPlace::cells): its answer.
    template <bool at_cells>
    CHIARO_INLINE void result(std::int64_t item) const {
        constexpr int halo = SpaoTile::halo;
        const BlockCell its(places, item);
        const std::int32_t x = its.grid_x(), y = its.grid_y(), z = its.grid_z();
        if (x >= to.count[0] || y >= to.count[1] || z >= to.count[2] || !its.is_asked()) return;
        SpaoBlock own = block;
        own.tile = tiles + its.block;
        CoarseAround around;
        if (block.goes_on) around = coarse.around<at_cells>(x, y, z);
        const std::int32_t in_tile =
            (its.z() + halo) * SpaoTile::slice + (its.y() + halo) * SpaoTile::row + halo + its.x();
        const std::int64_t at = std::int64_t(z) * to.slice + y * to.row + x;
        std::uint16_t out[8][1];
        find_piece<at_cells, float, 1>(own, SpaoPiece<CoarseAround>{in_tile, x, y, &around},
                                       own.weight ? own.weight + at : nullptr, out);
        if (to.to)
            to.to[at] = out[0][0];
        else
            octants[at] = {{out[0][0], out[1][0], out[2][0], out[3][0], out[4][0], out[5][0], out[6][0], out[7][0]}};
    }
};

/// Cells of blocks from stored levels, or from sums.
template <class Kernel>
struct AccessBatch {
    Kernel kernel;
    const BlockPlace* places;
    GridTarget to;

    CHIARO_INLINE void result(std::int64_t item) const {
        const BlockCell its(places, item);
        const std::int32_t x = its.grid_x(), y = its.grid_y(), z = its.grid_z();
        if (x < to.count[0] && y < to.count[1] && z < to.count[2])
            access_row<float>(kernel,
                              SpaoCells{x, 1, y, z, to.to + std::int64_t(z) * to.slice + std::int64_t(y) * to.row + x});
    }
};

/// The table of OpacitySums, 0 at first, in three steps: a thread for each row of cells, then for each line along y,
/// and along z.
struct SumTable {
    OpacityGrid opacity;
    std::int64_t* sums;

    CHIARO_INLINE std::int64_t row() const { return opacity.count[0] + 1; }
    CHIARO_INLINE std::int64_t slice() const { return row() * (opacity.count[1] + 1); }
    CHIARO_INLINE void along_x(std::int64_t item) const {
        sum_cells(opacity, int(item % opacity.count[1]), int(item / opacity.count[1]), sums);
    }
    CHIARO_INLINE void along_y(std::int64_t item) const {
        add_up(sums + item / row() * slice() + item % row(), opacity.count[1] + 1, row(), 1);
    }
    CHIARO_INLINE void along_z(std::int64_t item) const { add_up(sums + item, opacity.count[2] + 1, slice(), 1); }
};

// What fills a grid, cell by cell: besides OpacityGrid, which is copied, and EveryOther.

/// Means of 2 × 2 × 2 cells; the first of all lies at `first` on each axis.
struct MeanOfEight {
    OpacityGrid from;
    std::int32_t first;
    CHIARO_INLINE std::uint16_t at(int x, int y, int z) const {
        return EightCells(from, first + 2 * x, first + 2 * y, first + 2 * z).mean();
    }
};
/// What crosses 2 × 2 × 2 cells.
struct CrossingOfEight {
    OpacityGrid from;
    CHIARO_INLINE std::uint16_t at(int x, int y, int z) const {
        return EightCells(from, 2 * x, 2 * y, 2 * z).crossing();
    }
};
struct CornerWeights {
    OpacityGrid finest;
    CHIARO_INLINE std::uint16_t at(int x, int y, int z) const {
        return corner_weight(EightCells(finest, 2 * x - 1, 2 * y - 1, 2 * z - 1).mean());
    }
};
struct NextNBuffer {
    OpacityGrid from;
    std::int32_t distance;
    CHIARO_INLINE std::uint16_t at(int x, int y, int z) const { return nbuffer_cell(from, distance, x, y, z); }
};

}  // namespace chiaro::kernel

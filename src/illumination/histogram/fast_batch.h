// The same kernels as a card's threads call them: a column, a bin of a row or a cell each, of many blocks side by side.
#pragma once
#include "illumination/cells/block_place.h"
#include "illumination/histogram/bin_grid.h"
#include "illumination/histogram/fast_kernel.h"

namespace chiaro::kernel {

/// Packed histograms of a plane of cells of each of many blocks.
struct HistogramPlane {
    static constexpr int cells = FastBlock::edge * FastBlock::edge;
    const BlockPlace* places;
    std::int32_t first_block;        ///< of all that are asked for
    std::int32_t z;                  ///< in the block
    std::int32_t bins;               ///< of a vector
    const std::int16_t* histograms;  ///< forward, backward of each cell of each block, x fastest
};

/// One of the items of blocks side by side, `size` each.
struct FastItem {
    std::uint32_t block;
    std::int32_t i;
    CHIARO_INLINE FastItem(std::int64_t item, std::int32_t size)
        : block(std::uint32_t(item) / std::uint32_t(size)), i(std::int32_t(item - std::int64_t(block) * size)) {}
};
static_assert(FastBlock::edge == BlockPlace::edge);

/// Blocks whose room, zero at first, is in memory at the same time. The steps below take so many items() of each.
struct FastBatch {
    static constexpr int nodes = FastBlock::nodes, edge = FastBlock::edge;
    const FastBlock* blocks;  ///< with room for all rows and cells of a plane
    const BlockPlace* places;
    BinGrid grid;
    const std::uint32_t* code;           ///< of each bin, as FastBlock::tile
    std::int32_t bins, tile_size, step;  ///< of a vector; of a block; cells from one node to the next
    float* normals;                      ///< of each cell of a plane of each block
    std::int16_t* histograms;            ///< as HistogramPlane
    // Of one launch:
    Columns columns;
    FastBox box;
    std::int32_t z;  ///< of nodes or cells

    CHIARO_INLINE std::int32_t row() const { return nodes * bins; }

protected:
    CHIARO_INLINE float* line_of(const FastBlock& b, int y) const { return b.line + 4 * y * row(); }
    CHIARO_INLINE float* near_of(const FastBlock& b, int cell) const { return b.near_bins + 2 * cell * bins; }
    CHIARO_INLINE bool is_node(std::uint32_t block, int x, int y) const {
        const std::int32_t* first = places[block].first;
        const int at[] = {first[0] + x, first[1] + y, first[2] + z};
        return grid.holds(at[0], at[1], at[2]) && at[0] % step == 0 && at[1] % step == 0 && at[2] % step == 0;
    }
};

struct LoadTile : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return tile_size; }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, tile_size);
        const FastBlock& b = blocks[its.block];
        const std::int32_t* first = places[its.block].first;
        const int x_there = first[0] - b.fine_first + its.i % b.tile_row,
                  y_there = first[1] - b.fine_first + its.i / b.tile_row % b.tile_row,
                  z_there = first[2] - b.fine_first + its.i / b.tile_slice;
        b.tile[its.i] = grid.holds(x_there, y_there, z_there) ? code[*grid.cell(x_there, y_there, z_there)] : 0;
    }
};

struct MoveColumns : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return columns.width() * columns.height(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, items());
        move_column(blocks[its.block], columns, its.i % columns.width(), its.i / columns.width(), z);
    }
};

struct SumColumns : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return (nodes + 2 * box.half_y) * bins; }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, items());
        sum_row<float>(blocks[its.block], columns, box, its.i / bins, its.i % bins);
    }
};

struct SumRows : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return row(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, items());
        const FastBlock& b = blocks[its.block];
        running_sums<float>(b.rows + its.i, row(), nodes, box.half_y, [&](int y, std::int32_t sum) {
            add_weighted<float>(b, box, sum, (z * nodes + y) * row() + its.i);
        });
    }
};

struct InterpolatePlanes : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return nodes * row(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, items());
        interpolate_planes<float>(blocks[its.block], between(z), its.i);
    }
};

struct InterpolateRows : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return edge * row(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, items());
        const FastBlock& b = blocks[its.block];
        const int y = its.i / row();
        interpolate_rows<float>(b, between(y), its.i % row(), line_of(b, y));
    }
};

struct CountNear : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return HistogramPlane::cells; }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, items());
        const FastBlock& b = blocks[its.block];
        const int x = its.i % edge, y = its.i / edge;
        if (!is_node(its.block, x, y)) return;
        const std::int32_t* first = places[its.block].first;
        const Float3 n = grid.normal(first[0] + x, first[1] + y, first[2] + z);
        float* const normal = normals + 3 * item;
        normal[0] = n.x, normal[1] = n.y, normal[2] = n.z;
        count_near(b, in_tile(b, x, y, z), normal, near_of(b, its.i));
    }
};

struct FinishCells : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return HistogramPlane::cells * bins; }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, items());
        const FastBlock& b = blocks[its.block];
        const int cell = its.i / bins, x = cell % edge, y = cell / edge;
        if (!is_node(its.block, x, y)) return;
        const std::int64_t at = std::int64_t(its.block) * HistogramPlane::cells + cell;
        finish_bins<float>(b, line_of(b, y), between(x), normals + 3 * at, near_of(b, cell), its.i % bins,
                           histograms + 2 * at * bins);
    }
};

}  // namespace chiaro::kernel

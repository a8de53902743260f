// The same kernels as a GPU's threads call them: a column, a bin of a row or a cell each, of many blocks side by side.
#pragma once
#include "illumination/histogram/fast_kernel.h"
#include "illumination/histogram/slab.h"

namespace chiaro::kernel {

static_assert(FastBlock::edge == HistogramSlab::edge);

/// Blocks whose room, zero at first, is in memory at the same time: of all planes of nodes, and of a slab. The steps
/// below take so many items() of each.
struct FastBatch {
    static constexpr int nodes = FastBlock::nodes, edge = FastBlock::edge;
    const FastBlock* blocks;
    const std::uint32_t* code;  ///< of each bin, as FastBlock::tile
    std::int32_t tile_size;     ///< of a block
    float* normals;             ///< of each cell of a slab
    HistogramSlab slab;
    // Of one launch:
    Columns columns;
    FastBox box;

protected:
    CHIARO_INLINE std::int32_t row() const { return nodes * slab.bins; }
    CHIARO_INLINE std::int32_t rows() const { return nodes + 2 * box.half_y; }  ///< whose sums a plane of nodes needs
    CHIARO_INLINE std::int32_t* columns_of(const FastBlock& b, int node_z) const {
        return b.columns + node_z * columns.width() * columns.height() * slab.bins;
    }
    CHIARO_INLINE float* plane_of(const FastBlock& b, int plane) const { return b.plane + plane * 3 * nodes * row(); }
    CHIARO_INLINE float* line_of(const FastBlock& b, int line) const { return b.line + line * 4 * row(); }
    CHIARO_INLINE float* near_of(const FastBlock& b, int cell) const {
        return b.near_bins + cell * FastBlock::near_numbers(slab.bins);
    }
};

struct LoadTile : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return tile_size; }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, tile_size);
        const FastBlock& b = blocks[its.block];
        const std::int32_t* first = slab.places[its.block].first;
        const int x_there = first[0] - b.fine_first + its.i % b.tile_row,
                  y_there = first[1] - b.fine_first + its.i / b.tile_row % b.tile_row,
                  z_there = first[2] - b.fine_first + its.i / b.tile_slice;
        const BinGrid& grid = slab.grid;
        b.tile[its.i] = grid.holds(x_there, y_there, z_there) ? code[*grid.cell(x_there, y_there, z_there)] : 0;
    }
};

struct FillColumns : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return nodes * columns.width() * columns.height(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, items());
        const FastBlock& b = blocks[its.block];
        const int x = its.i % columns.width(), y = its.i / columns.width() % columns.height(),
                  z = its.i / columns.width() / columns.height();
        fill_column(b, columns, x, y, z, b.columns + its.i * slab.bins);
    }
};

struct SumColumns : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return nodes * rows() * slab.bins; }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, items());
        const FastBlock& b = blocks[its.block];
        const int line = its.i / slab.bins, z = line / rows();
        sum_row<float>(columns, box, slab.bins, line % rows(), its.i % slab.bins, columns_of(b, z),
                       b.rows + z * rows() * row());
    }
};

struct SumRows : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return nodes * row(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, items());
        const FastBlock& b = blocks[its.block];
        const int z = its.i / row(), i = its.i % row();
        running_sums<float>(b.rows + z * rows() * row() + i, row(), nodes, box.half_y, [&](int y, std::int32_t sum) {
            const int at = (z * nodes + y) * row() + i;
            add_weighted(box.mass, box.blur, sum, b.mass + at, b.blur + at);
        });
    }
};

struct InterpolatePlanes : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return slab.planes * nodes * row(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, items());
        const FastBlock& b = blocks[its.block];
        const int plane = its.i / (nodes * row());
        interpolate_planes<float>(b, between(slab.z + plane), its.i % (nodes * row()), plane_of(b, plane));
    }
};

struct InterpolateRows : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return slab.planes * edge * row(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, items());
        const FastBlock& b = blocks[its.block];
        const int line = its.i / row();
        interpolate_rows<float>(slab.bins, plane_of(b, line / edge), between(line % edge), its.i % row(),
                                line_of(b, line));
    }
};

struct CountNear : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return slab.cells(); }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const SlabCell cell(slab, item);
        if (!cell.is_node(slab)) return;
        const FastBlock& b = blocks[cell.block];
        const Float3 n = slab.grid.normal(cell.at[0], cell.at[1], cell.at[2]);
        float* const normal = normals + 3 * item;
        normal[0] = n.x, normal[1] = n.y, normal[2] = n.z;
        count_near<float>(b, in_tile(b, cell.x, cell.y, cell.z), normal, near_of(b, cell.i));
    }
};

struct FinishCells : FastBatch {
    CHIARO_INLINE std::int32_t items() const { return slab.cells() * slab.bins; }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, items());
        const std::int64_t at = std::int64_t(its.block) * slab.cells() + its.i / slab.bins;
        const SlabCell cell(slab, at);
        if (!cell.is_node(slab)) return;
        const FastBlock& b = blocks[cell.block];
        finish_bins<float>(b, line_of(b, cell.i / edge), between(cell.x), normals + 3 * at, near_of(b, cell.i),
                           its.i % slab.bins, slab.histograms + 2 * at * slab.bins);
    }
};

}  // namespace chiaro::kernel

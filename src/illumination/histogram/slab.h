// Packed histograms of some planes of cells of each of many blocks, as a GPU's threads make and use them.
#pragma once
#include "illumination/cells/block_place.h"
#include "illumination/histogram/bin_grid.h"

namespace chiaro::kernel {

struct HistogramSlab {
    static constexpr int edge = BlockPlace::edge, plane = edge * edge;
    BinGrid grid;
    const BlockPlace* places;
    std::int32_t first_block;  ///< of all that are asked for
    std::int32_t z, planes;    ///< the first in the block, and how many
    std::int32_t step, bins;   ///< cells from one node to the next; of a vector
    std::int16_t* histograms;  ///< forward, backward of each cell of each plane of each block, x fastest; of nodes only

    CHIARO_INLINE std::int32_t cells() const { return planes * plane; }
};

/// A cell of a slab: `x`, `y` and `z` in its block, `at` in the grid.
struct SlabCell {
    std::uint32_t block;
    std::int32_t i;  ///< in the slab of its block
    std::int32_t x, y, z, at[3];

    CHIARO_INLINE SlabCell(const HistogramSlab& slab, std::int64_t item) {
        const BlockShare its(item, slab.cells());
        block = its.block, i = its.i;
        x = i % HistogramSlab::edge, y = i / HistogramSlab::edge % HistogramSlab::edge;
        z = slab.z + i / HistogramSlab::plane;
        const std::int32_t* first = slab.places[block].first;
        at[0] = first[0] + x, at[1] = first[1] + y, at[2] = first[2] + z;
    }
    CHIARO_INLINE bool is_node(const HistogramSlab& slab) const {
        return slab.grid.holds(at[0], at[1], at[2]) && at[0] % slab.step == 0 && at[1] % slab.step == 0 &&
               at[2] % slab.step == 0;
    }
};

}  // namespace chiaro::kernel

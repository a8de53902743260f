// Which cells a codebook is trained with: half of the choice falls on edges, where histograms differ most and light
// shows; half on all cells, which words must serve too.
#pragma once
#include "illumination/histogram/random.h"
#include "illumination/histogram/slab.h"

namespace chiaro::kernel {

/// Of one block: how likely a cell is chosen.
struct ChoiceShares {
    double all, at_edges;  ///< more

    static ChoiceShares of(double wanted, double cells, double edges) {
        return {wanted / 2 / cells, edges > 0 ? wanted / 2 / edges : 0};
    }
    CHIARO_INLINE bool takes(std::uint64_t cell, bool is_at_edge) const {
        return random_share(cell) < all + (is_at_edge ? at_edges : 0);
    }
};

struct EdgeTest {
    BinGrid grid;
    float least;  ///< bins a cell

    CHIARO_INLINE bool operator()(int x, int y, int z) const {
        const Float3 g = grid.gradient(x, y, z);
        return g.x * g.x + g.y * g.y + g.z * g.z > least * least;
    }
};

/// Rows of blocks side by side, as a GPU's threads look at them.
struct BlockRows {
    static constexpr int of_block = BlockPlace::edge * BlockPlace::edge;
    EdgeTest is_at_edge;
    const BlockPlace* places;

    /// use(which of the blocks' cells, its number in the grid, x, y, z) for the cells of a row.
    template <class Use>
    CHIARO_INLINE void for_cells(std::int64_t row, Use&& use) const {
        const BlockShare its(row, of_block);
        const std::int32_t* first = places[its.block].first;
        const int y = first[1] + its.i % BlockPlace::edge, z = first[2] + its.i / BlockPlace::edge;
        for (int i = 0; i < BlockPlace::edge; ++i)
            if (const int x = first[0] + i; is_at_edge.grid.holds(x, y, z))
                use(row * BlockPlace::edge + i, is_at_edge.grid.cell(x, y, z) - is_at_edge.grid.bins, x, y, z);
    }
};

/// How many cells of each row are at edges.
struct CountEdges : BlockRows {
    std::int32_t* counts;

    CHIARO_INLINE void operator()(std::int64_t row) const {
        std::int32_t count = 0;
        for_cells(row, [&](std::int64_t, std::int64_t, int x, int y, int z) { count += is_at_edge(x, y, z); });
        counts[row] = count;
    }
};

struct ChooseRow : BlockRows {
    const ChoiceShares* shares;  ///< of each block

    template <class Use>
    CHIARO_INLINE void for_chosen(std::int64_t row, Use&& use) const {
        const ChoiceShares its = shares[row / of_block];
        for_cells(row, [&](std::int64_t i, std::int64_t cell, int x, int y, int z) {
            if (its.takes(std::uint64_t(cell), is_at_edge(x, y, z))) use(i);
        });
    }
};
/// How many cells of each row are chosen.
struct CountChosen : ChooseRow {
    std::int32_t* counts;

    CHIARO_INLINE void operator()(std::int64_t row) const {
        std::int32_t count = 0;
        for_chosen(row, [&](std::int64_t) { ++count; });
        counts[row] = count;
    }
};
/// The place of each in the list of all, from 1 on; 0 before.
struct PlaceChosen : ChooseRow {
    const std::int32_t* first;  ///< how many come before each row
    std::int32_t* place;

    CHIARO_INLINE void operator()(std::int64_t row) const {
        std::int32_t next = first[row];
        for_chosen(row, [&](std::int64_t i) { place[i] = ++next; });
    }
};

}  // namespace chiaro::kernel

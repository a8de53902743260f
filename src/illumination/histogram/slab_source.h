// Slabs of histograms by brute force and of moving balls, as threads of a GPU find them.
#pragma once
#include "illumination/histogram/exact_kernel.h"
#include "illumination/histogram/packing_view.h"
#include "illumination/histogram/slab.h"
#include "illumination/histogram/sweep_kernel.h"

namespace chiaro::kernel {

/// Places of cells in histograms of fewer of them: a thread for each cell.
struct PlaceCells {
    const std::uint16_t *bins, *place;  ///< of a cell; of a bin
    std::uint16_t* places;

    CHIARO_INLINE void operator()(std::int64_t i) const { places[i] = place[bins[i]]; }
};

/// What lies ahead of a cell's gradient, then all of its ball: a thread for each.
struct CountSlab {
    HistogramSlab slab;
    BallView ball;
    const std::uint16_t* places;  ///< of each cell of the grid
    std::int32_t count;           ///< of places
    float* counts;                ///< [cell][2][4][count], zero at first

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const SlabCell cell(slab, item / 2);
        if (!cell.is_node(slab)) return;
        const auto [x, y, z] = cell.at;
        const Float3 g = slab.grid.gradient(x, y, z);
        const float gradient[] = {g.x, g.y, g.z};
        BinGrid grid = slab.grid;
        grid.bins = places;
        count_ball(ball, places_around(grid, x, y, z), gradient, item % 2 != 0, count, counts + item * 4 * count);
    }
};

/// Then the packed histogram of each half.
struct PackSlab {
    HistogramSlab slab;
    PackingView packing;  ///< null: places are packed bins
    std::int32_t count;   ///< of places
    const float* counts;
    float* packed;  ///< room for a vector each

    CHIARO_INLINE void operator()(std::int64_t item) const {
        if (!SlabCell(slab, item / 2).is_node(slab)) return;
        const float *const ahead = counts + item / 2 * 8 * count, *const all = ahead + 4 * count;
        float* const sums = packed + item * slab.bins;
        for (std::int32_t k = 0; k < slab.bins; ++k) sums[k] = 0;
        for (std::int32_t k = 0; k < count; ++k) {
            const float share = half_of(count_of(ahead, count, k), count_of(all, count, k), item % 2 != 0);
            packing.low ? packing.add(k, share, sums) : void(sums[k] = share);
        }
        for (std::int32_t k = 0; k < slab.bins; ++k) slab.histograms[item * slab.bins + k] = packed_share(sums[k]);
    }
};

/// A ball that moves along a row of cells: a thread for each row of each block.
struct SweepSlab {
    HistogramSlab slab;
    SweptRow row;
    std::int32_t* counts;  ///< room for a vector each

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const SlabCell first(slab, item * HistogramSlab::edge);
        if (!first.is_node(slab)) return;
        const auto [x, y, z] = first.at;
        row.find(x, min(x + HistogramSlab::edge, slab.grid.count[0]), y, z, slab.step, counts + item * slab.bins,
                 slab.histograms + item * HistogramSlab::edge * 2 * slab.bins, 2 * slab.bins * slab.step);
    }
};

}  // namespace chiaro::kernel

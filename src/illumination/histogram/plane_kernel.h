// What threads of a card do with a plane of histograms of many blocks, which nobody keeps.
#pragma once
#include "illumination/histogram/fast_batch.h"
#include "illumination/histogram/nearest_kernel.h"

namespace chiaro::kernel {

/// Identifiers of nodes: a thread for each half of a cell. The guess is the word of the node below, which may not be
/// known yet (0): the nearest word is the same whatever the guess.
struct AssignPlane {
    HistogramPlane plane;
    CodebookView book;
    std::uint16_t* words;  ///< two a node, x fastest; zero at first
    std::int32_t cells[3], nodes[3], step;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item / 2, HistogramPlane::cells);
        const std::int32_t* first = plane.places[its.block].first;
        const int x = first[0] + its.i % FastBlock::edge, y = first[1] + its.i / FastBlock::edge,
                  z = first[2] + plane.z;
        if (x >= cells[0] || y >= cells[1] || z >= cells[2] || x % step || y % step || z % step) return;
        const std::int64_t slice = std::int64_t(nodes[1]) * nodes[0],
                           at = 2 * (z / step * slice + std::int64_t(y / step) * nodes[0] + x / step) + item % 2;
        const std::int32_t guess = z > 0 ? words[at - 2 * slice] : 0;
        std::int32_t difference;
        words[at] = std::uint16_t(nearest_word(book, plane.histograms + item * plane.bins, guess, difference));
    }
};

/// Some cells' histograms to a list of them: a thread for each cell.
struct TakeFromPlane {
    HistogramPlane plane;
    const std::int32_t* place;  ///< in the list, of each cell of each block that is asked for; -1: not there
    std::int16_t* list;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const FastItem its(item, HistogramPlane::cells);
        const std::int32_t to = place[(plane.first_block + its.block) * std::int64_t(BlockPlace::cells) +
                                      plane.z * HistogramPlane::cells + its.i];
        if (to < 0) return;
        for (int k = 0; k < 2 * plane.bins; ++k)
            list[2 * std::int64_t(to) * plane.bins + k] = plane.histograms[2 * item * plane.bins + k];
    }
};

}  // namespace chiaro::kernel

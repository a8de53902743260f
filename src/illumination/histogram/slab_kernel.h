// What threads of a GPU do with slabs of histograms, which nobody keeps.
#pragma once
#include "illumination/histogram/nearest_kernel.h"
#include "illumination/histogram/slab.h"

namespace chiaro::kernel {

/// Identifiers of nodes: a thread for each half of those above each other, so that the word of one is the next one's
/// guess. The first one's is the word of the node below where that is known, else 0: the nearest word is the same
/// whatever the guess. Then one for each histogram whose neighbours did not tell.
struct AssignSlab {
    HistogramSlab slab;
    CodebookView codebook;
    std::uint16_t* codewords;  ///< two a node, x fastest; zero at first
    std::int32_t nodes[3];

    /// later(i) for each histogram of the slab for which all words have yet to be tried.
    template <class Later>
    CHIARO_INLINE void find_near(std::int64_t item, Later&& later) const {
        const BlockShare its(item / 2, HistogramSlab::plane);
        const std::int64_t first = std::int64_t(its.block) * slab.cells() + its.i;
        FoundCodeword found{codeword_below(SlabCell(slab, first).at, item % 2), 0, false};
        const std::int16_t* below = nullptr;
        for (std::int32_t p = 0; p < slab.planes; ++p) {
            const std::int64_t i = 2 * (first + p * HistogramSlab::plane) + item % 2;
            if (!SlabCell(slab, i / 2).is_node(slab)) continue;
            const std::int16_t* const x = slab.histograms + i * slab.bins;
            if (!is_same(codebook, below, x)) found = near_codeword(codebook, x, found.codeword);
            codeword_of(i) = std::uint16_t(found.codeword);
            if (!found.is_nearest) later(i);
            below = x;
        }
    }
    CHIARO_INLINE void try_all(std::int64_t i) const {
        const std::int16_t* const x = slab.histograms + i * slab.bins;
        std::uint16_t& codeword = codeword_of(i);
        const std::int32_t d = difference_of(codebook, x, codebook.codewords + std::int64_t(codeword) * codebook.bins);
        codeword = std::uint16_t(codeword_of_all(codebook, x, {codeword, d, false}).codeword);
    }

private:
    CHIARO_INLINE std::int64_t index(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return 2 * ((std::int64_t(z / slab.step) * nodes[1] + y / slab.step) * nodes[0] + x / slab.step);
    }
    CHIARO_INLINE std::uint16_t& codeword_of(std::int64_t i) const {
        const SlabCell cell(slab, i / 2);
        return codewords[index(cell.at[0], cell.at[1], cell.at[2]) + i % 2];
    }
    CHIARO_INLINE std::int32_t codeword_below(const std::int32_t (&at)[3], std::int64_t half) const {
        const bool is_known = slab.grid.holds(at[0], at[1], at[2]) && at[2] > 0;
        return is_known ? codewords[index(at[0], at[1], at[2] - 1) + half] : 0;
    }
};

/// Some cells' histograms to a list of them: a thread for each cell.
struct TakeFromSlab {
    HistogramSlab slab;
    const std::int32_t* place;  ///< in the list, from 1 on, of each cell of each block that is asked for; 0: not there
    std::int16_t* list;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockShare its(item, slab.cells());
        const std::int32_t to = place[(slab.first_block + its.block) * std::int64_t(BlockPlace::cells) +
                                      slab.z * HistogramSlab::plane + its.i];
        if (to == 0) return;
        for (int k = 0; k < 2 * slab.bins; ++k)
            list[2 * std::int64_t(to - 1) * slab.bins + k] = slab.histograms[2 * item * slab.bins + k];
    }
};

}  // namespace chiaro::kernel

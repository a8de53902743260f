// The nearest others of every word, as a GPU's threads find them.
#pragma once
#include "illumination/histogram/nearest_kernel.h"

namespace chiaro::kernel {

/// A thread for each two words.
struct CodewordDifferences {
    CodebookView codebook;
    std::int32_t* differences;  ///< [word][word]

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int64_t a = item / codebook.count, b = item % codebook.count;
        differences[item] =
            difference_of(codebook, codebook.codewords + a * codebook.bins, codebook.codewords + b * codebook.bins);
    }
};

/// Then again: how many are nearer to the one than the other, of equals those before it, is the other's place.
struct RankNeighbours {
    CodebookView codebook;
    const std::int32_t* differences;
    std::uint16_t* neighbours;
    float* distances;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int32_t codeword = std::int32_t(item / codebook.count), other = std::int32_t(item % codebook.count);
        if (codeword == other) return;
        const std::int32_t* const to = differences + std::int64_t(codeword) * codebook.count;
        std::int32_t rank = 0;
        for (std::int32_t c = 0; c < codebook.count && rank < codebook.listed; ++c)
            rank += c != codeword && (to[c] < to[other] || (to[c] == to[other] && c < other));
        if (rank >= codebook.listed) return;
        const std::int64_t at = std::int64_t(codeword) * codebook.listed + rank;
        neighbours[at] = std::uint16_t(other), distances[at] = distance_of(codebook, to[other]);
    }
};

}  // namespace chiaro::kernel

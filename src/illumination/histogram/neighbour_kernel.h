// The nearest others of every word, as a card's threads find them.
#pragma once
#include "illumination/histogram/nearest_kernel.h"

namespace chiaro::kernel {

/// A thread for each two words.
struct WordDifferences {
    CodebookView book;
    std::int32_t* differences;  ///< [word][word]

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int64_t a = item / book.count, b = item % book.count;
        differences[item] = difference_of(book, book.words + a * book.bins, book.words + b * book.bins);
    }
};

/// Then again: how many are nearer to the one than the other, of equals those before it, is the other's place.
struct RankNeighbours {
    CodebookView book;
    const std::int32_t* differences;
    std::uint16_t* neighbours;
    float* distances;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int32_t word = std::int32_t(item / book.count), other = std::int32_t(item % book.count);
        if (word == other) return;
        const std::int32_t* const to = differences + std::int64_t(word) * book.count;
        std::int32_t rank = 0;
        for (std::int32_t c = 0; c < book.count && rank < book.listed; ++c)
            rank += c != word && (to[c] < to[other] || (to[c] == to[other] && c < other));
        if (rank >= book.listed) return;
        const std::int64_t at = std::int64_t(word) * book.listed + rank;
        neighbours[at] = std::uint16_t(other), distances[at] = distance_of(book, to[other]);
    }
};

}  // namespace chiaro::kernel

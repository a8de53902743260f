// Words as full histograms: the mean of some of their members.
#pragma once
#include "illumination/histogram/ball.h"
#include "illumination/histogram/histograms.h"
#include "illumination/histogram/word_kernel.h"

namespace chiaro {

/// How many members make a word, at most; chosen at random. With σ the spread of a word's members their mean errs by
/// σ / 5.7, which adds 1.5 % to the RMSE of O.
inline constexpr int most_members = 32;

/// Of all words, those of one after the other.
struct WordMembers {
    std::vector<std::int32_t> begin;  ///< of each word, and of none after the last
    std::vector<kernel::WordMember> members;

    std::span<const kernel::WordMember> of(std::size_t word) const {
        return std::span(members).subspan(std::size_t(begin[word]), std::size_t(begin[word + 1] - begin[word]));
    }
};

/// The mean of so many members, whose sum is `histogram`, as 16-bit shares of the largest, scaled so that rounding does
/// not change the sum.
void store_word(std::span<const float> histogram, int members, std::size_t word, LocalHistograms& to);

/// Fills `shares` and `scale` from the unpacked histograms of members by brute force; `whole`: of whole balls.
/// Cost: 32 histograms a word.
void find_words(const Device& device, const BinnedCells& cells, const Ball& ball, bool whole,
                LocalHistograms& histograms, Progress& progress);

}  // namespace chiaro

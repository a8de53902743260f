// Words as full histograms: the mean of some of their members.
#pragma once
#include "illumination/histogram/ball.h"
#include "illumination/histogram/codeword_kernel.h"
#include "illumination/histogram/histograms.h"

namespace chiaro {

/// How many members make a word, at most; chosen at random. With σ the spread of a word's members their mean errs by
/// σ / 5.7, which adds 1.5 % to the RMSE of O.
inline constexpr int max_members = 32;

/// Of all words, those of one after the other.
struct CodewordMembers {
    std::vector<std::int32_t> begin;  ///< of each word, and of none after the last
    std::vector<kernel::CodewordMember> members;

    std::span<const kernel::CodewordMember> of(std::size_t codeword) const {
        return std::span(members).subspan(std::size_t(begin[codeword]),
                                          std::size_t(begin[codeword + 1] - begin[codeword]));
    }
};

/// The mean of so many members, whose sum is `histogram`, as 16-bit shares of the largest, scaled so that rounding does
/// not change the sum.
void store_codeword(std::span<const float> histogram, int members, std::size_t codeword, LocalHistograms& to);

/// Fills `shares` and `scale` from the unpacked histograms of members by brute force; `whole`: of whole balls.
/// Cost: 32 histograms a word.
void find_codewords(const Device& device, const BinnedCells& cells, const Ball& ball, bool whole,
                    LocalHistograms& histograms, Progress& progress);

}  // namespace chiaro

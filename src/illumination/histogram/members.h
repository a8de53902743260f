// Words as full histograms: the mean of some of their members.
#pragma once
#include "illumination/histogram/ball.h"
#include "illumination/histogram/histograms.h"

namespace chiaro {

/// How many members make a word, at most; chosen at random. With σ the spread of a word's members their mean errs by
/// σ / 5.7, which adds 1.5 % to the RMSE of O.
inline constexpr int most_members = 32;

/// Fills `shares` and `scale` from the unpacked histograms of members by brute force; `whole`: of whole balls.
/// Cost: 32 histograms a word.
void find_words(const Device& device, const BinnedCells& cells, const Ball& ball, bool whole,
                LocalHistograms& histograms, Progress& progress);

}  // namespace chiaro

// The histograms that a codebook is trained with.
#pragma once
#include "illumination/histogram/source.h"

namespace chiaro {

/// Both histograms of about `cells_wanted` cells, one after the other: half at edges, |∇f| > 1/200 of the
/// bins a cell (those elsewhere are much alike), the others anywhere; at random, from a quarter of all blocks (at least
/// 64).
std::vector<PackedHistogram> sample_histograms(const Device& device, const HistogramData& data, HistogramPath path,
                                               int cells_wanted, Progress& progress);

}  // namespace chiaro

// The histograms that a codebook is trained with.
#pragma once
#include "illumination/histogram/choice_kernel.h"
#include "illumination/histogram/packed_histograms.h"
#include "illumination/histogram/source.h"

namespace chiaro {

/// Both histograms of about `cells_wanted` cells, one after the other: half at edges, |∇f| > 1/200 of the
/// bins a cell (those elsewhere are much alike), the others anywhere; at random, from a quarter of all blocks (at least
/// 64). A GPU keeps them.
PackedHistograms sample_histograms(const Device& device, const HistogramData& data, HistogramPath path,
                                   int cells_wanted, Progress& progress);

inline kernel::EdgeTest edge_test(const kernel::BinGrid& cells, const Binning& binning) {
    return {cells, std::max(1.0f, float(binning.count) / 200)};
}

}  // namespace chiaro

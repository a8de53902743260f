// Fewer bins for comparing histograms: a linear map from bins to packed bins whose columns sum to 1.
#pragma once
#include <chiaro/lighting.h>

#include <cstdint>
#include <span>
#include <vector>

#include "illumination/histogram/packing_view.h"

namespace chiaro {

/// Bin j goes to packed bin low[j] with share[j] / 256, and to the next with the rest. (Two are enough for the paper's
/// rule too: what a removed bin held lies in the nearest that remain on either side.)
struct Packing {
    static constexpr int whole = kernel::PackingView::whole;
    int packed = 1;
    std::vector<std::uint16_t> low, share;

    bool is_one_to_one() const;  ///< every bin goes to a single packed bin
    /// Joins the bins of a histogram.
    void pack(std::span<const float> histogram, std::span<float> packed_histogram) const;
    kernel::PackingView view() const { return {low.data(), share.data()}; }
};

/// `counts` is the volume's histogram. At most as many packed bins as there are bins.
/// paper: the smallest bin goes (of equals the first), half to each neighbour that remains, until enough are left;
/// shares are rounded to 256ths. uniform: intervals of equal length. cumulative: the intervals for which
/// Σ (C - C_packed)² over the bins is least, C the cumulative histogram and C_packed what it is with each interval's
/// share spread evenly; by dynamic programming over at most 512 possible ends.
Packing make_packing(HistogramPacking kind, int packed_bins, std::span<const std::uint64_t> counts);

}  // namespace chiaro

// Histograms of the whole ball from those of the neighbour, as the paper moves its sphere.
#pragma once
#include "illumination/histogram/ball.h"
#include "illumination/histogram/source.h"

namespace chiaro {

/// What a ball that moves by one cell can keep exactly: LH_k(x) = Σ [f(x') = k] / N over 0 < d <= r, N the number of
/// cells in the ball; cells weigh the same, and the ball is one, not two halves. (Weights 1/d² all change at every
/// step, and each cell's own ∇f splits its ball.)
class SweptHistograms : public HistogramSource {
public:
    SweptHistograms(const BinnedCells& cells, const Packing& packing, int radius);

    /// Each histogram comes twice, there being but one half. Cost: some 2 π r² cells of the ball's surface for each.
    void find(std::size_t block, int step, const Wanted& wanted, const UseRow& use_row) const override;

private:
    void find_row(const std::pair<int, int>& x, int y, int z, int step, PackedHistogram* histograms) const;
    template <int sign>
    void add(int x, int y, int z, std::vector<std::int32_t>& counts) const;

    const Packing& packing_;
    const Ball ball_;
    std::int64_t in_ball_ = 0;
};

}  // namespace chiaro

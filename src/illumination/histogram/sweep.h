// Histograms of the whole ball from those of the neighbour, as the paper moves its sphere.
#pragma once
#include "illumination/histogram/ball.h"
#include "illumination/histogram/source.h"
#include "illumination/histogram/sweep_kernel.h"

namespace chiaro {

/// The moving ball of a row, which points to what it is made of; the ball's cells weigh the same.
kernel::SweptRow swept_row(const kernel::BinGrid& cells, const Packing& packing, const Ball& ball);

/// What a ball that moves by one cell can keep exactly: LH_k(x) = Σ [f(x') = k] / N over 0 < d <= r, N the number of
/// cells in the ball; cells weigh the same, and the ball is one, not two halves. (Weights 1/d² all change at every
/// step, and each cell's own ∇f splits its ball.)
class SweptHistograms : public HistogramSource {
public:
    SweptHistograms(const BinnedCells& cells, const Packing& packing, int radius);

    /// Each histogram comes twice, there being but one half. Cost: some 2 π r² cells of the ball's surface for each.
    void find(std::size_t block, int step, const Wanted& wanted, const UseRow& use_row) const override;

private:
    const Ball ball_;
    const kernel::SweptRow row_;
};

}  // namespace chiaro

// Histograms by brute force over the ball: the truth that faster paths are measured against.
#pragma once
#include <chiaro/device.h>

#include <span>

#include "illumination/histogram/ball.h"
#include "illumination/histogram/cells.h"

namespace chiaro {

/// Finds histograms cell by cell (Ropinski 2008, eq. 1, normalised once):
///     LH_k(x) = (2 / W) Σ [f(x') = k] / d² over the half ball 0 < d <= r, W = Σ 1/d² over the whole ball,
/// where the half is the one that ∇f points to (forward) or the other (backward). Cells in the plane between them, and
/// all of them where ∇f = 0, count half for each. What lies outside the volume is missing.
class ExactHistograms {
public:
    /// A place for each bin; `ball` may also weigh all cells alike.
    ExactHistograms(const Device& device, const BinnedCells& cells, const Ball& ball);
    /// `place` maps bins to places of a histogram of `places`. Cost: two bytes a cell.
    ExactHistograms(const Device& device, const BinnedCells& cells, const Ball& ball,
                    const std::vector<std::uint16_t>& place, int places);

    int places() const { return places_; }
    /// Of one cell: forward, then backward, `places` numbers each. Any thread may ask. Cost: some 4 r³ cells of the
    /// ball.
    void find(int x, int y, int z, float* histograms) const;

    using Half = kernel::BallPart;
    /// Adds the histogram of one cell, of one half ball or of the whole, to `histogram`.
    void add(int x, int y, int z, Half half, float* histogram) const;

private:
    /// Σ 1/d² / W by place, on the gradient's side or of the whole ball; until the thread asks again.
    const float* count(int x, int y, int z, const std::array<float, 3>& gradient, bool whole) const;

    const BinnedCells& cells_;
    const Ball& ball_;
    std::vector<std::uint16_t> own_;  ///< places of the cells; empty: their bins
    const int places_;
    const Isa isa_;
};

}  // namespace chiaro

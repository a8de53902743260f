// Histograms by brute force over the ball: the truth that faster paths are measured against.
#pragma once
#include <chiaro/device.h>

#include <span>

#include "illumination/histogram/ball.h"
#include "illumination/histogram/cells.h"

namespace chiaro {

/// Up to 16 cells of a row that lie next to each other.
struct CellRun {
    std::int32_t x, y, z, count;
};

/// Finds histograms cell by cell (Ropinski 2008, eq. 1, normalised once):
///     LH_k(x) = (2 / W) Σ [f(x') = k] / d² over the half ball 0 < d <= r, W = Σ 1/d² over the whole ball,
/// where the half is the one that ∇f points to (forward) or the other (backward). Cells in the plane between them, and
/// all of them where ∇f = 0, count half for each. What lies outside the volume is missing.
class ExactHistograms {
public:
    /// `place` maps bins to places of a histogram of `places`; `ball` may also weigh all cells alike.
    ExactHistograms(const Device& device, const BinnedCells& cells, const Ball& ball, std::vector<std::uint16_t> place,
                    int places);

    int places() const { return places_; }
    /// Of the cells of a run one after the other: forward, then backward, `places` numbers each. Any thread may ask.
    /// Cost: some 4 r³ cells of the ball for each, 16 at a time.
    void find(const CellRun& run, float* histograms) const;

    enum class Half { forward, backward, whole };
    /// Adds the histogram of one cell, of one half ball or of the whole, to `histogram`.
    void add(int x, int y, int z, Half half, float* histogram) const;

private:
    /// Copies the places around a run of up to `width` cells.
    kernel::PlaceTile load(const CellRun& run, int width, std::vector<std::uint16_t>& tile) const;
    /// Those around a cell, where they lie if they can serve as they are.
    kernel::PlaceTile around(int x, int y, int z, std::vector<std::uint16_t>& tile) const;

    const BinnedCells& cells_;
    const Ball& ball_;
    const std::vector<std::uint16_t> place_;
    const int places_;
    bool places_are_bins_ = true;
    const Isa isa_;
};

}  // namespace chiaro

// Boxes of coarse cells whose weighted sum is nearest to 1/d², and to what its first moment needs.
#pragma once
#include <vector>

#include "illumination/histogram/fast_block.h"

namespace chiaro {

/// The far part of a ball, d² > near: boxes for M0 = Σ w / W and for the blurred P whose gradient is M1 = Σ w ω / W.
struct FilterFit {
    std::vector<kernel::FastBox> boxes;
    int reach = 0;  ///< the longest box's half length, coarse cells
};

/// Cells with d² up to this are counted one by one: 32 of them.
inline constexpr int near_square = 4;

/// Least squares over the cells of the ball, weighted by distance, of what interpolation between the centres of coarse
/// cells makes of the boxes; so that the far cells' sum, and that of their cosines over a half space, are exact.
/// Found once for a radius: 20 ms for 16, 0.7 s for 64. ∫ f ω / d² = ∇ ∫ f (1/d - 1/r): M1 is the gradient of one
/// blurred number, not three more sums.
FilterFit fit_filters(int radius);

}  // namespace chiaro

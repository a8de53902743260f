#include "illumination/histogram/sweep.h"

namespace chiaro {

kernel::SweptRow swept_row(const kernel::BinGrid& cells, const Packing& packing, const Ball& ball) {
    std::int64_t in_ball = -1;  // but for the middle
    for (const Ball::Row& row : ball.rows) in_ball += 2 * row.reach + 1;
    return {.ball = ball.view(),
            .cells = cells,
            .packing = packing.view(),
            .bins = padded_bins(packing.packed),
            .scale = double(packed_one) / (double(in_ball) * Packing::whole)};
}

SweptHistograms::SweptHistograms(const BinnedCells& cells, const Packing& packing, int radius)
    : HistogramSource(cells, padded_bins(packing.packed)),
      ball_(radius, false),
      row_(swept_row(cells.view(), packing, ball_)) {}

void SweptHistograms::find(std::size_t block, int step, const Wanted& wanted, const UseRow& use_row) const {
    std::vector<PackedHistogram> histograms(std::size_t(2 * block_edge * bins_));
    std::vector<std::int32_t> counts(static_cast<std::size_t>(bins_));
    for_rows(block, step, wanted, [&](const std::pair<int, int>& x, int y, int z) {
        row_.find(x.first, x.second, y, z, step, counts.data(), histograms.data(), 2 * bins_);
        use_row(y, z, histograms.data());
    });
}

}  // namespace chiaro

#include "illumination/histogram/sweep.h"

namespace chiaro {

SweptHistograms::SweptHistograms(const BinnedCells& cells, const Packing& packing, int radius)
    : HistogramSource(cells, padded_bins(packing.packed)), packing_(packing), ball_(radius, false) {
    for (const Ball::Row& row : ball_.rows) in_ball_ += 2 * row.reach + 1;
    --in_ball_;  // the middle
}

template <int sign>
void SweptHistograms::add(int x, int y, int z, std::vector<std::int32_t>& counts) const {
    const auto [nx, ny, nz] = cells_.grid.count;
    if (x < 0 || x >= nx || y < 0 || y >= ny || z < 0 || z >= nz) return;
    const std::uint16_t bin = cells_.data()[cells_.grid.index(x, y, z)];
    const int low = packing_.low[bin], share = packing_.share[bin];
    counts[std::size_t(low)] += sign * share;
    if (share < Packing::whole) counts[std::size_t(low) + 1] += sign * (Packing::whole - share);
}

void SweptHistograms::find_row(const std::pair<int, int>& range, int y, int z, int step,
                               PackedHistogram* histograms) const {
    std::vector<std::int32_t> counts(std::size_t(bins_), 0);
    for (const Ball::Row& row : ball_.rows)
        for (int dx = -row.reach; dx <= row.reach; ++dx) add<1>(range.first + dx, y + row.dy, z + row.dz, counts);
    const double scale = double(packed_one) / (double(in_ball_) * Packing::whole);
    for (int x = range.first; x < range.second; ++x) {
        if ((x - range.first) % step == 0) {
            add<-1>(x, y, z, counts);
            for (int half = 0; half < 2; ++half)
                for (int k = 0; k < bins_; ++k) *histograms++ = PackedHistogram(counts[std::size_t(k)] * scale + 0.5);
            add<1>(x, y, z, counts);
        }
        for (const Ball::Row& row : ball_.rows) {
            add<-1>(x - row.reach, y + row.dy, z + row.dz, counts);
            add<1>(x + 1 + row.reach, y + row.dy, z + row.dz, counts);
        }
    }
}

void SweptHistograms::find(std::size_t block, int step, const Wanted& wanted, const UseRow& use_row) const {
    std::vector<PackedHistogram> histograms(std::size_t(2 * block_edge * bins_));
    for_rows(block, step, wanted, [&](const std::pair<int, int>& x, int y, int z) {
        find_row(x, y, z, step, histograms.data());
        use_row(y, z, histograms.data());
    });
}

}  // namespace chiaro

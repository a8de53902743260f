#include "illumination/histogram/exact.h"

#include <numeric>

#include "illumination/histogram/launch.h"

namespace chiaro {

ExactHistograms::ExactHistograms(const Device& device, const BinnedCells& cells, const Ball& ball)
    : cells_(cells), ball_(ball), places_(cells.binning.count), isa_(device.isa) {}

ExactHistograms::ExactHistograms(const Device& device, const BinnedCells& cells, const Ball& ball,
                                 const std::vector<std::uint16_t>& place, int places)
    : cells_(cells), ball_(ball), places_(places), isa_(device.isa) {
    own_.resize(cells.grid.size());
    for (std::size_t i = 0; i < own_.size(); ++i) own_[i] = place[cells.data()[i]];
}

const float* ExactHistograms::count(int x, int y, int z, const std::array<float, 3>& gradient, bool whole) const {
    constexpr std::size_t copies = 4;
    thread_local std::vector<float> counts;
    const auto [nx, ny, nz] = cells_.grid.count;
    const kernel::CellPlaces cell{(own_.empty() ? cells_.data() : own_.data()) + cells_.grid.index(x, y, z),
                                  nx,
                                  nx * ny,
                                  {x, y, z},
                                  {nx - 1 - x, ny - 1 - y, nz - 1 - z}};
    const auto n = std::size_t(places_);
    counts.assign(copies * n, 0);
    kernel::histogram_functions_for(isa_).count_ball(ball_.view(), cell, gradient.data(), whole, places_,
                                                     counts.data());
    for (std::size_t k = 0; k < n; ++k)
        counts[k] = (counts[k] + counts[n + k]) + (counts[2 * n + k] + counts[3 * n + k]);
    return counts.data();
}

void ExactHistograms::find(int x, int y, int z, float* histograms) const {
    const auto gradient = cells_.gradient(x, y, z);
    float *const forward = histograms, *const backward = histograms + places_;
    const float* counted = count(x, y, z, gradient, false);
    std::copy_n(counted, places_, forward);
    counted = count(x, y, z, gradient, true);
    for (int k = 0; k < places_; ++k) {
        backward[k] = 2 * std::max(counted[k] - forward[k], 0.0f);
        forward[k] *= 2;
    }
}

void ExactHistograms::add(int x, int y, int z, Half half, float* histogram) const {
    auto gradient = cells_.gradient(x, y, z);
    if (half == Half::backward)
        for (float& component : gradient) component = -component;
    const float* counted = count(x, y, z, gradient, half == Half::whole);
    const float scale = half == Half::whole ? 1 : 2;
    for (int k = 0; k < places_; ++k) histogram[k] += scale * counted[k];
}

}  // namespace chiaro

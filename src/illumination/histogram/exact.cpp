#include "illumination/histogram/exact.h"

#include "illumination/histogram/exact_kernel.h"
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
    kernel::BinGrid grid = cells_.view();
    if (!own_.empty()) grid.bins = own_.data();
    counts.assign(copies * std::size_t(places_), 0);
    kernel::histogram_functions_for(isa_).count_ball(ball_.view(), kernel::places_around(grid, x, y, z),
                                                     gradient.data(), whole, places_, counts.data());
    for (int k = 0; k < places_; ++k) counts[std::size_t(k)] = kernel::count_of(counts.data(), places_, k);
    return counts.data();
}

void ExactHistograms::find(int x, int y, int z, float* histograms) const {
    const auto gradient = cells_.gradient(x, y, z);
    float *const forward = histograms, *const backward = histograms + places_;
    const float* counted = count(x, y, z, gradient, false);
    std::copy_n(counted, places_, forward);
    counted = count(x, y, z, gradient, true);
    for (int k = 0; k < places_; ++k) {
        backward[k] = kernel::half_of(forward[k], counted[k], true);
        forward[k] = kernel::half_of(forward[k], counted[k], false);
    }
}

void ExactHistograms::add(int x, int y, int z, Half half, float* histogram) const {
    auto gradient = cells_.gradient(x, y, z);
    if (half == Half::backward)
        for (float& component : gradient) component = -component;
    const float* counted = count(x, y, z, gradient, half == Half::whole);
    for (int k = 0; k < places_; ++k) histogram[k] += kernel::scale_of(half) * counted[k];
}

}  // namespace chiaro

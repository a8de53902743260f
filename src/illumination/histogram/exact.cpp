#include "illumination/histogram/exact.h"

#include <cstring>

#include "illumination/histogram/launch.h"

namespace chiaro {
namespace {

constexpr int lanes = kernel::run_lanes;

/// What a run needs while it is computed; kept by each thread.
struct Scratch {
    std::vector<std::uint16_t> tile;
    std::vector<float> all, forward;
};

}  // namespace

ExactHistograms::ExactHistograms(const Device& device, const BinnedCells& cells, const Ball& ball,
                                 std::vector<std::uint16_t> place, int places)
    : cells_(cells), ball_(ball), place_(std::move(place)), places_(places), isa_(device.isa) {
    for (std::size_t j = 0; j < place_.size(); ++j) places_are_bins_ = places_are_bins_ && place_[j] == j;
}

kernel::PlaceTile ExactHistograms::load(const CellRun& run, int width, std::vector<std::uint16_t>& tile) const {
    const auto [nx, ny, nz] = cells_.grid.count;
    const int r = ball_.radius, row = width + 2 * r, slice = row * (2 * r + 1), outside = places_;
    tile.assign(std::size_t(slice) * (2 * r + 1), std::uint16_t(outside));
    for (int k = -r; k <= r; ++k)
        for (int j = -r; j <= r; ++j) {
            const int y = run.y + j, z = run.z + k;
            if (y < 0 || y >= ny || z < 0 || z >= nz) continue;
            const std::uint16_t* from = cells_.data() + cells_.grid.index(0, y, z);
            std::uint16_t* to = tile.data() + (k + r) * slice + (j + r) * row - (run.x - r);
            for (int x = std::max(run.x - r, 0); x < std::min(run.x + run.count + r, nx); ++x) to[x] = place_[from[x]];
        }
    return {tile.data() + r * slice + r * row + r, row, slice};
}

kernel::PlaceTile ExactHistograms::around(int x, int y, int z, std::vector<std::uint16_t>& tile) const {
    const auto [nx, ny, nz] = cells_.grid.count;
    const int r = ball_.radius;
    const auto is_inside = [r](int i, int n) { return i >= r && i + r < n; };
    if (places_are_bins_ && is_inside(x, nx) && is_inside(y, ny) && is_inside(z, nz))
        return {cells_.data() + cells_.grid.index(x, y, z), nx, nx * ny};
    return load({x, y, z, 1}, 1, tile);
}

void ExactHistograms::find(const CellRun& run, float* histograms) const {
    thread_local Scratch scratch;
    const kernel::PlaceTile tile = load(run, lanes, scratch.tile);
    float gradient[3 * lanes] = {};
    for (int i = 0; i < run.count; ++i) {
        const auto g = cells_.gradient(run.x + i, run.y, run.z);
        for (int axis = 0; axis < 3; ++axis) gradient[axis * lanes + i] = g[axis];
    }
    const std::size_t size = std::size_t(places_ + 1) * lanes;
    scratch.all.assign(size, 0), scratch.forward.assign(size, 0);
    kernel::histogram_functions_for(isa_).exact(ball_.view(), tile, gradient, run.count, scratch.all.data(),
                                                scratch.forward.data());
    for (int i = 0; i < run.count; ++i)
        for (int k = 0; k < places_; ++k) {
            const std::size_t at = std::size_t(k * lanes + i);
            histograms[(2 * i) * places_ + k] = 2 * scratch.forward[at];
            histograms[(2 * i + 1) * places_ + k] = 2 * (scratch.all[at] - scratch.forward[at]);
        }
}

void ExactHistograms::add(int x, int y, int z, Half half, float* histogram) const {
    thread_local Scratch scratch;
    const kernel::PlaceTile tile = around(x, y, z, scratch.tile);
    auto gradient = cells_.gradient(x, y, z);
    if (half == Half::backward)
        for (float& component : gradient) component = -component;
    scratch.all.assign(std::size_t(places_) + 1, 0);
    kernel::histogram_functions_for(isa_).exact_half(ball_.view(), tile, gradient.data(), half == Half::whole,
                                                     scratch.all.data());
    const float scale = half == Half::whole ? 1 : 2;
    for (int k = 0; k < places_; ++k) histogram[k] += scale * scratch.all[std::size_t(k)];
}

}  // namespace chiaro

#include "illumination/histogram/emission.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/threads.h"
#include "volume/occupancy.h"

namespace chiaro {
std::vector<kernel::Rgba> emission_of_codewords(const Device& device, const LocalHistograms& h, BinOptics optics,
                                                HistogramModel model) {
    const float highest = *std::max_element(optics.emission.begin(), optics.emission.end());
    for (std::size_t j = 0; j < optics.alpha.size(); ++j)
        optics.alpha[j] *= (optics.emission[j] - 1) / std::max(highest - 1, 1e-6f);
    optics.emission.clear();
    std::vector<kernel::Rgba> codewords;
    for (const auto& [r, g, b, sum] : codeword_sums(device, h, optics)) {
        const float share = std::min(sum, 0.999f);
        const float edge = model == HistogramModel::paper ? share : -std::expm1(std::log1p(-share) / float(h.radius));
        const float scale = sum > 0 ? edge / sum : 0;
        codewords.push_back({scale * r, scale * g, scale * b, edge});
    }
    return codewords;
}

namespace {

/// Cubes of nodes, of which one holds a word that glows.
class EmissiveNodes {
public:
    EmissiveNodes(const Device& device, const LocalHistograms& h, const kernel::HistogramView& view) {
        for (int axis = 0; axis < 3; ++axis) count_[axis] = (h.nodes[axis] - 1) / edge + 1;
        std::vector<std::uint8_t> emits;
        for (int codeword = 0; codeword < h.codewords; ++codeword)
            emits.push_back(view.emission_codewords[codeword].a > 0);
        emits_.resize(std::size_t(count_[0]) * count_[1] * count_[2]);
        const auto* pairs = reinterpret_cast<const CodewordPair*>(view.identifiers);
        const auto [nx, ny, nz] = h.nodes;
        parallel_for(device.threads, count_[2], 1, [&, nx = nx, ny = ny, nz = nz](std::int64_t k, std::int64_t) {
            for (int z = int(k) * edge; z < std::min((int(k) + 1) * edge, nz); ++z)
                for (int y = 0; y < ny; ++y) {
                    const CodewordPair* row = pairs + (std::size_t(z) * ny + y) * nx;
                    std::uint8_t* to = emits_.data() + (std::size_t(k) * count_[1] + y / edge) * count_[0];
                    for (int x = 0; x < nx; ++x) to[x / edge] |= emits[row[x].forward] | emits[row[x].backward];
                }
        });
    }

    /// Whether one may glow among the nodes that samples at voxel coordinates [low, low + cell_edge] read.
    bool any(const kernel::GridView& grid, const std::array<int, 3>& low) const {
        std::array<int, 3> first, last;
        const float scale[] = {grid.nodes_per_voxel.x, grid.nodes_per_voxel.y, grid.nodes_per_voxel.z};
        const float shift[] = {grid.shift.x, grid.shift.y, grid.shift.z};
        for (int a = 0; a < 3; ++a) {
            const double from = double(low[a]) * scale[a] + shift[a], to = from + double(cell_edge) * scale[a];
            first[a] = std::clamp(int(std::floor(from - 1e-3)) / edge, 0, count_[a] - 1);
            last[a] = std::clamp((int(std::floor(to + 1e-3)) + 1) / edge, 0, count_[a] - 1);
        }
        for (int z = first[2]; z <= last[2]; ++z)
            for (int y = first[1]; y <= last[1]; ++y)
                for (int x = first[0]; x <= last[0]; ++x)
                    if (emits_[(std::size_t(z) * count_[1] + y) * count_[0] + x]) return true;
        return false;
    }

private:
    static constexpr int edge = 4;
    std::array<int, 3> count_;
    std::vector<std::uint8_t> emits_;
};

}  // namespace

std::vector<std::uint8_t> emissive_occupancy(const Device& device, const Medium::Data& medium, const LocalHistograms& h,
                                             const kernel::HistogramView& view) {
    const DeviceVolume::Data& volume = medium.volume.data();
    CellRanges ranges = volume.cells;
    const EmissiveNodes nodes(device, h, view);
    constexpr float lit = std::numeric_limits<float>::quiet_NaN();
    const auto [nx, ny, nz] = ranges.count;
    parallel_for(device.threads, nz, 1, [&, nx = nx, ny = ny](std::int64_t z, std::int64_t) {
        float* low = ranges.low.data() + std::size_t(z) * ny * nx;
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x, ++low)
                if (nodes.any(view.grid, {x * cell_edge, y * cell_edge, int(z) * cell_edge})) *low = lit;
    });
    const RangeTest visible = visible_range(medium.table);
    return make_occupancy(
        ranges, [&](float low, float high) { return std::isnan(low) || visible(low, high); }, volume.device.threads);
}

}  // namespace chiaro

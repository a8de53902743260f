#include "pathtrace/majorants.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/threads.h"
#include "pathtrace/regions.h"

namespace chiaro {
namespace {

constexpr double step_cost = 0.4;  ///< of crossing into a region, over that of a tentative collision
/// Bounding a voxel interval costs about as much as so many collisions.
constexpr double voxel_cost = 2;

float packed(float majorant, int reach) {
    const auto bits = std::bit_cast<std::uint32_t>(majorant);
    constexpr std::uint32_t mask = kernel::reach_mask;
    return std::bit_cast<float>(((bits + mask) & ~mask) | std::uint32_t(reach));
}

/// [level][first]: the largest of 2^level entries; where fewer follow, of those.
std::vector<float> runs_of(const Medium::Data& medium) {
    std::vector<float> runs = extinctions_of(medium);
    const std::size_t count = runs.size();
    for (std::size_t width = 1; 2 * width <= count; width *= 2) {
        const std::size_t below = runs.size() - count;
        for (std::size_t i = 0; i < count; ++i)
            runs.push_back(std::max(runs[below + i], runs[below + std::min(i + width, count - 1)]));
    }
    return runs;
}

/// The largest extinction that interpolated values in each cell can have; rounding can carry a value a little beyond
/// those at the corners.
std::vector<float> extinction_of_cells(const Medium::Data& medium, const std::vector<float>& runs, int threads) {
    const CellRanges& cells = medium.volume.data().cells;
    const OpticalTable& table = medium.table;
    const kernel::RangeMaximumView largest{runs.data(), int(table.entries.size())};
    const double last = double(table.entries.size()) - 1;
    std::vector<float> majorants(cells.low.size());
    parallel_for(threads, std::int64_t(majorants.size()), 1 << 14, [&](std::int64_t begin, std::int64_t end) {
        for (auto c = begin; c < end; ++c) {
            const double low = cells.low[c], high = cells.high[c];
            const double beyond = std::max(std::abs(low), std::abs(high)) * 4e-7 * table.index_scale + 1.0 / 256;
            const double reach = low == high ? 0 : beyond;
            const auto entry = [&](double index) { return int(std::clamp(index + 0.5, 0.0, last)); };
            majorants[c] =
                largest.between<float>(entry(table.index_of(low) - reach), entry(table.index_of(high) + reach));
        }
    });
    return majorants;
}

/// Extinctions add.
std::vector<float> largest_of_cells(const Medium::Data& medium, const std::vector<float>& runs, int threads) {
    if (!is_mixed(medium)) return extinction_of_cells(medium, runs, threads);
    std::vector<float> sums(medium.cell_count());
    for_each_channel(medium, [&](const Medium::Data& channel) {
        const std::vector<float> its = extinction_of_cells(channel, runs_of(channel), threads);
        for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += its[c] * (1 + 1e-6f);
    });
    return sums;
}

/// Each cell becomes the largest of those `shift` cells away along one axis and itself.
void widen(std::vector<float>& cells, std::array<int, 3> count, int axis, int shift, int threads) {
    const std::vector<float> from = cells;
    const std::int64_t distance = axis == 0 ? 1 : axis == 1 ? count[0] : std::int64_t(count[0]) * count[1];
    const int nx = count[0], ny = count[1];
    parallel_for(threads, std::int64_t(count[1]) * count[2], 64, [&](std::int64_t begin, std::int64_t end) {
        for (auto row = begin; row < end; ++row) {
            const int at = axis == 1 ? int(row % ny) : int(row / ny);
            float* to = &cells[std::size_t(row) * nx];
            const float* here = &from[std::size_t(row) * nx];
            const auto relax = [&](std::int64_t offset, int first, int last) {
                for (int x = first; x < last; ++x) to[x] = std::max(to[x], here[x + offset]);
            };
            const bool along = axis == 0;
            if (along || at >= shift) relax(-shift * distance, along ? std::min(shift, nx) : 0, nx);
            if (along || at + shift < count[axis]) relax(shift * distance, 0, along ? std::max(nx - shift, 0) : nx);
        }
    });
}

/// What a voxel of way costs in a region that reaches so far.
double cost(double majorant_per_voxel, int reach) {
    return step_cost / (cell_edge * (reach + 0.5)) + majorant_per_voxel;
}

}  // namespace

float max_extinction(const DeviceVolume::Data& volume) {
    double longest_mm = 0;  // no way is longer
    for (int axis = 0; axis < 3; ++axis) longest_mm += volume.dimensions[axis] * volume.geometry.spacing_mm[axis];
    return float((1 << 22) / longest_mm);
}

std::vector<float> extinctions_of(const Medium::Data& medium) {
    const float most = max_extinction(medium.volume.data());
    std::vector<float> extinctions;
    for (const auto& entry : medium.table.entries) extinctions.push_back(std::min(entry.extinction_per_mm, most));
    return extinctions;
}

Majorants make_majorants(const Medium::Data& medium, int threads) {
    const std::array<int, 3> count = medium.volume.data().cells.count;
    const bool surfaces = medium.shape.mode == Mode::iso;
    const auto is_empty = [&](std::size_t c) { return !(medium.cells[c] & 1); };
    Majorants majorants{{}, runs_of(medium)};
    std::vector<float> largest =
        surfaces ? std::vector<float>(medium.cell_count(), 1) : largest_of_cells(medium, majorants.runs, threads);
    const double edge = medium.volume.geometry().smallest_spacing_mm();
    std::vector<float> best(largest.size());
    for (std::size_t c = 0; c < best.size(); ++c) {
        const int reach = is_empty(c) ? medium.cells[c] >> 1 : 0;
        const float majorant = is_empty(c) ? 0 : largest[c];
        best[c] = float(cost(edge * majorant, reach));
        const bool fine = !surfaces && !is_mixed(medium) && best[c] > voxel_cost;
        if (fine) best[c] = float(voxel_cost);
        majorants.cells.push_back(packed(majorant, fine ? kernel::by_voxel : reach));
    }
    if (surfaces) return majorants;
    for (int reach = 1, shift = 1; reach <= 8; shift = reach, reach *= 2) {
        for (int axis = 0; axis < 3; ++axis) widen(largest, count, axis, shift, threads);
        for (std::size_t c = 0; c < best.size(); ++c) {
            const float offer = float(cost(edge * largest[c], reach));
            if (offer >= best[c]) continue;
            best[c] = offer;
            majorants.cells[c] = packed(largest[c], reach);
        }
    }
    return majorants;
}

Majorants one_majorant(const Medium::Data& medium) {
    Majorants majorants{{}, runs_of(medium)};
    float largest = 0;
    for_each_channel(medium, [&](const Medium::Data& channel) {
        const std::vector<float> its = extinctions_of(channel);
        largest += *std::max_element(its.begin(), its.end()) * (1 + 1e-6f);
    });
    majorants.cells.assign(medium.cell_count(), packed(largest, kernel::by_voxel - 1));
    return majorants;
}

}  // namespace chiaro

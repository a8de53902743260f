// Empty-space skipping (Krüger and Westermann 2003): cells whose range of values the transfer function leaves empty,
// and around each cell the largest cube of cells that are all like it.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "classify/medium.h"
#include "core/threads.h"

namespace chiaro {
namespace {

/// One byte per cell, x fastest.
struct CellGrid {
    std::array<int, 3> count;
    std::vector<std::uint8_t> at;
    std::size_t row(int y, int z) const { return (std::size_t(z) * count[1] + y) * count[0]; }
};

constexpr std::uint8_t farthest = 126;  ///< distances are clamped, so that one fits beside the occupied bit

CellGrid occupied_cells(const CellRanges& ranges, const RangeTest& is_visible, int threads) {
    CellGrid cells{ranges.count, std::vector<std::uint8_t>(ranges.low.size())};
    parallel_for(threads, std::int64_t(ranges.low.size()), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
        for (auto c = begin; c < end; ++c) cells.at[c] = is_visible(ranges.low[c], ranges.high[c]);
    });
    return cells;
}

/// Distances to the nearest cell of the other kind: a neighbour of the same kind offers its own distance and one more,
/// one of the other kind offers 1.
class KindDistance {
public:
    explicit KindDistance(const CellGrid& kind)
        : kind_(kind), distance_{kind.count, std::vector<std::uint8_t>(kind.at.size(), farthest)} {}

    /// Chebyshev distances in two sweeps over 13 neighbours each (Borgefors 1986), exact for this metric. What lies
    /// beyond the volume counts for nothing.
    const CellGrid& compute() {
        sweep(1);
        sweep(-1);
        return distance_;
    }

private:
    void sweep(int sign) {
        const auto [nx, ny, nz] = kind_.count;
        for (int k = 0; k < nz; ++k)
            for (int j = 0; j < ny; ++j) {
                const int z = sign > 0 ? k : nz - 1 - k, y = sign > 0 ? j : ny - 1 - j;
                const int before = z - sign, above = y - sign;
                const std::size_t row = kind_.row(y, z);
                if (before >= 0 && before < nz)
                    for (int other = std::max(y - 1, 0); other <= std::min(y + 1, ny - 1); ++other)
                        relax_row(kind_.row(other, before), row, nx);
                if (above >= 0 && above < ny) relax_row(kind_.row(above, z), row, nx);
                const int first = sign > 0 ? 1 : nx - 2;
                for (int x = first; x >= 0 && x < nx; x += sign) relax(row + x - sign, row + x);
            }
    }

    /// From the neighbours at x - 1, x and x + 1 in a row that the sweep has already passed.
    void relax_row(std::size_t neighbours, std::size_t row, int nx) {
        for (int shift : {0, -1, 1}) {
            const int first = std::max(0, -shift), last = std::min(nx, nx - shift);
            // Plain pointers: the compiler turns this loop into vector instructions.
            const std::uint8_t *kind = &kind_.at[row], *their_kind = &kind_.at[neighbours] + shift;
            const std::uint8_t* theirs = &distance_.at[neighbours] + shift;
            std::uint8_t* distance = &distance_.at[row];
            for (int x = first; x < last; ++x) distance[x] = nearer(distance[x], kind[x] == their_kind[x], theirs[x]);
        }
    }

    void relax(std::size_t neighbour, std::size_t cell) {
        auto& distance = distance_.at[cell];
        distance = nearer(distance, kind_.at[neighbour] == kind_.at[cell], distance_.at[neighbour]);
    }

    static std::uint8_t nearer(std::uint8_t distance, bool same_kind, std::uint8_t neighbour) {
        const std::uint8_t offer = (same_kind ? neighbour : 0) + 1;
        return std::min(distance, offer);
    }

    const CellGrid& kind_;
    CellGrid distance_;
};

/// Rounding in interpolation can reach a little beyond the values, unless they are all the same.
double reach_beyond(double low, double high) {
    return low == high ? 0 : std::max(std::abs(low), std::abs(high)) * 4e-7;
}

}  // namespace

RangeTest visible_range(const OpticalTable& table) {
    const double last = double(table.entries.size()) - 1;
    std::vector<int> before(table.entries.size() + 1, 0);
    for (std::size_t j = 0; j < table.entries.size(); ++j)
        before[j + 1] = before[j] + (table.entries[j].extinction_per_mm > 0);
    return [before = std::move(before), &table, last](float low, float high) {
        const double reach = low == high ? 0 : 1.0 / 256 + table.index_scale * reach_beyond(low, high);
        const auto entry = [&](double index) { return int(std::clamp(index + 0.5, 0.0, last)); };
        return before[entry(table.index_of(high) + reach) + 1] > before[entry(table.index_of(low) - reach)];
    };
}

RangeTest crossed_range(const DeviceVolume::Data& volume, const std::vector<IsoSurface>& surfaces) {
    std::vector<double> stored;
    for (const IsoSurface& surface : surfaces) stored.push_back((surface.value - volume.offset) / volume.scale);
    return [stored = std::move(stored)](float low, float high) {
        const double reach = reach_beyond(low, high);
        return std::any_of(stored.begin(), stored.end(),
                           [&](double v) { return v >= low - reach && v <= high + reach; });
    };
}

std::vector<std::uint8_t> make_occupancy(const CellRanges& ranges, const RangeTest& is_visible, int threads,
                                         double& occupied_fraction) {
    const CellGrid occupied = occupied_cells(ranges, is_visible, threads);
    KindDistance distances(occupied);
    const CellGrid& distance = distances.compute();

    std::vector<std::uint8_t> codes(occupied.at.size() + 1);
    std::size_t count = 0;
    for (std::size_t c = 0; c < occupied.at.size(); ++c) {
        codes[c] = std::uint8_t(2 * (distance.at[c] - 1) + occupied.at[c]);
        count += occupied.at[c];
    }
    occupied_fraction = double(count) / double(occupied.at.size());
    return codes;
}

}  // namespace chiaro

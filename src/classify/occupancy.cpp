// Empty-space skipping (Krüger and Westermann 2003): cells whose range of values the transfer function leaves empty,
// and around each cell the largest cube of cells that are all like it.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "classify/medium.h"

namespace chiaro {
namespace {

/// One byte per cell, x fastest.
struct CellGrid {
    std::array<int, 3> count;
    std::vector<std::uint8_t> at;
    std::uint8_t* row(int y, int z) { return at.data() + (std::size_t(z) * count[1] + y) * count[0]; }
};

constexpr std::uint8_t farthest = 126;  ///< distances are clamped, so that one fits beside the occupied bit

/// 1 where the transfer function leaves something visible.
CellGrid occupied_cells(const CellRanges& ranges, const OpticalTable& table) {
    const int last = int(table.entries.size()) - 1;
    std::vector<int> visible_before(table.entries.size() + 1, 0);
    for (int j = 0; j <= last; ++j)
        visible_before[j + 1] = visible_before[j] + (table.entries[j].extinction_per_mm > 0);
    CellGrid cells{ranges.count, std::vector<std::uint8_t>(ranges.low.size())};
    for (std::size_t c = 0; c < ranges.low.size(); ++c) {
        // Rounding in interpolation can reach a little beyond the cell's values, unless they are all the same.
        const double low = ranges.low[c], high = ranges.high[c];
        const double reach =
            low == high ? 0 : 1.0 / 256 + table.index_scale * std::max(std::abs(low), std::abs(high)) * 4e-7;
        const int first = std::clamp(int(std::floor(table.index_of(low) - reach + 0.5)), 0, last);
        const int final = std::clamp(int(std::floor(table.index_of(high) + reach + 0.5)), 0, last);
        cells.at[c] = visible_before[final + 1] > visible_before[first];
    }
    return cells;
}

/// distance = min(distance, neighbour + 1) over the rows of cells around (y, z) that a sweep has already passed.
void relax_from_row(const std::uint8_t* neighbour, std::uint8_t* row, int n) {
    for (int x = 0; x < n; ++x) row[x] = std::min<std::uint8_t>(row[x], neighbour[x] + 1);
    for (int x = 1; x < n; ++x) row[x] = std::min<std::uint8_t>(row[x], neighbour[x - 1] + 1);
    for (int x = 0; x + 1 < n; ++x) row[x] = std::min<std::uint8_t>(row[x], neighbour[x + 1] + 1);
}

/// Chebyshev distance in cells to the nearest cell that is 0, in two sweeps over 13 neighbours each (Borgefors 1986);
/// exact for this metric. What lies beyond the volume counts for nothing.
void chebyshev_distance(CellGrid& d) {
    const auto [nx, ny, nz] = d.count;
    for (int sign : {1, -1}) {
        for (int k = 0; k < nz; ++k)
            for (int j = 0; j < ny; ++j) {
                const int z = sign > 0 ? k : nz - 1 - k, y = sign > 0 ? j : ny - 1 - j;
                std::uint8_t* row = d.row(y, z);
                const int before = z - sign, above = y - sign;
                if (before >= 0 && before < nz)
                    for (int other = std::max(y - 1, 0); other <= std::min(y + 1, ny - 1); ++other)
                        relax_from_row(d.row(other, before), row, nx);
                if (above >= 0 && above < ny) relax_from_row(d.row(above, z), row, nx);
                for (int i = 1; i < nx; ++i) {
                    const int x = sign > 0 ? i : nx - 1 - i;
                    row[x] = std::min<std::uint8_t>(row[x], row[x - sign] + 1);
                }
            }
    }
}

}  // namespace

std::vector<std::uint8_t> make_occupancy(const CellRanges& ranges, const OpticalTable& table,
                                         double& occupied_fraction) {
    const CellGrid occupied = occupied_cells(ranges, table);
    CellGrid to_occupied = occupied, to_empty = occupied;
    for (auto& d : to_occupied.at) d = d ? 0 : farthest;
    for (auto& d : to_empty.at) d = d ? farthest : 0;
    chebyshev_distance(to_occupied);
    chebyshev_distance(to_empty);

    std::vector<std::uint8_t> codes(occupied.at.size() + 1);
    std::size_t count = 0;
    for (std::size_t c = 0; c < occupied.at.size(); ++c) {
        codes[c] = std::uint8_t(2 * (std::max(to_occupied.at[c], to_empty.at[c]) - 1) + occupied.at[c]);
        count += occupied.at[c];
    }
    occupied_fraction = double(count) / double(occupied.at.size());
    return codes;
}

}  // namespace chiaro

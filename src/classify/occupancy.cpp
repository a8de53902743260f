// Empty-space skipping (Krüger and Westermann 2003): cells whose range of values the transfer function leaves empty, and
// the largest aligned cubes of such cells.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "classify/medium.h"

namespace chiaro {
namespace {

/// One level of the pyramid over the cells.
struct Level {
    enum State : std::uint8_t { empty = 0, occupied = 1, mixed = 2 };
    std::array<int, 3> count;
    std::vector<std::uint8_t> state;
    std::uint8_t& at(int x, int y, int z) { return state[(std::size_t(z) * count[1] + y) * count[0] + x]; }
};

Level classify_cells(const CellRanges& ranges, const OpticalTable& table) {
    const int last = int(table.entries.size()) - 1;
    std::vector<int> visible_before(table.entries.size() + 1, 0);
    for (int j = 0; j <= last; ++j) visible_before[j + 1] = visible_before[j] + (table.entries[j].extinction_per_mm > 0);
    Level cells{ranges.count, std::vector<std::uint8_t>(ranges.low.size())};
    for (std::size_t c = 0; c < ranges.low.size(); ++c) {
        // Rounding in interpolation can reach a little beyond the cell's values, unless they are all the same.
        const double low = ranges.low[c], high = ranges.high[c];
        const double reach = low == high ? 0 : 1.0 / 256 + table.index_scale * std::max(std::abs(low), std::abs(high)) * 4e-7;
        const int first = std::clamp(int(std::floor(table.index_of(low) - reach + 0.5)), 0, last);
        const int final = std::clamp(int(std::floor(table.index_of(high) + reach + 0.5)), 0, last);
        cells.state[c] = visible_before[final + 1] > visible_before[first] ? Level::occupied : Level::empty;
    }
    return cells;
}

/// 2 × 2 × 2 cells to one; what lies beyond the volume agrees with everything.
Level halve(Level& fine) {
    Level coarse{{(fine.count[0] + 1) / 2, (fine.count[1] + 1) / 2, (fine.count[2] + 1) / 2}, {}};
    coarse.state.assign(std::size_t(coarse.count[0]) * coarse.count[1] * coarse.count[2], 0xff);
    for (int z = 0; z < fine.count[2]; ++z)
        for (int y = 0; y < fine.count[1]; ++y)
            for (int x = 0; x < fine.count[0]; ++x) {
                std::uint8_t& parent = coarse.at(x / 2, y / 2, z / 2);
                const std::uint8_t child = fine.at(x, y, z);
                parent = parent == 0xff || parent == child ? child : std::uint8_t(Level::mixed);
            }
    return coarse;
}

}  // namespace

std::vector<std::uint8_t> make_occupancy(const CellRanges& ranges, const OpticalTable& table, double& occupied_fraction) {
    std::vector<Level> levels{classify_cells(ranges, table)};
    while (std::max({levels.back().count[0], levels.back().count[1], levels.back().count[2]}) > 1) levels.push_back(halve(levels.back()));

    Level& cells = levels.front();
    std::vector<std::uint8_t> codes(cells.state.size() + 1);
    std::size_t cell = 0, occupied = 0;
    for (int z = 0; z < cells.count[2]; ++z)
        for (int y = 0; y < cells.count[1]; ++y)
            for (int x = 0; x < cells.count[0]; ++x, ++cell) {
                std::size_t level = 0;
                while (level + 1 < levels.size() && levels[level + 1].at(x >> (level + 1), y >> (level + 1), z >> (level + 1)) != Level::mixed) ++level;
                codes[cell] = std::uint8_t(2 * level + cells.state[cell]);
                occupied += cells.state[cell];
            }
    occupied_fraction = double(occupied) / double(cells.state.size());
    return codes;
}

}  // namespace chiaro

// The value ranges of a brick's cells.
#pragma once
#include <algorithm>
#include <array>

#include "volume/device_volume.h"

namespace chiaro {

/// Calls visit(cell, corner) for the brick's 4³ cells: their index, and where each begins in the brick.
template <class Visit>
void for_each_cell(std::array<int, 3> at, const std::array<int, 3>& count, const Visit& visit) {
    constexpr int per_brick = brick_edge / cell_edge;
    for (int c = 0; c < per_brick * per_brick * per_brick; ++c) {
        const std::array<int, 3> in{c % per_brick, c / per_brick % per_brick, c / (per_brick * per_brick)};
        const int x = at[0] * per_brick + in[0], y = at[1] * per_brick + in[1], z = at[2] * per_brick + in[2];
        if (x >= count[0] || y >= count[1] || z >= count[2]) continue;
        visit((std::size_t(z) * count[1] + y) * count[0] + x,
              std::array{in[0] * cell_edge + brick_before, in[1] * cell_edge + brick_before,
                         in[2] * cell_edge + brick_before});
    }
}

/// The ranges of the brick's cells, each over the voxels that samples inside it can touch: its 5³ and `margin` more on
/// each side. Of the brick's slices so many are there.
template <class Device, int margin = 0>
void fill_cells(const Device* brick, std::array<int, 3> at, int slices, CellRanges& cells) {
    constexpr int edge = cell_edge + 1 + 2 * margin;
    for_each_cell(at, cells.count, [&](std::size_t cell, const std::array<int, 3>& first) {
        const Device* corner =
            brick + (first[2] - margin) * brick_slice + (first[1] - margin) * brick_row + first[0] - margin;
        const int depth = std::min(edge, slices - first[2] + margin);
        // Columns side by side first: the compiler turns the inner loop into vector minima.
        Device low[edge], high[edge];
        std::copy_n(corner, edge, low);
        std::copy_n(corner, edge, high);
        for (int k = 0; k < depth; ++k)
            for (int j = 0; j < edge; ++j)
                for (int i = 0; i < edge; ++i) {
                    const Device v = corner[k * brick_slice + j * brick_row + i];
                    low[i] = std::min(low[i], v);
                    high[i] = std::max(high[i], v);
                }
        cells.low[cell] = float(*std::min_element(low, low + edge));
        cells.high[cell] = float(*std::max_element(high, high + edge));
    });
}

}  // namespace chiaro

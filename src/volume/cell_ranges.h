// The value ranges of a brick's cells.
#pragma once
#include <algorithm>
#include <array>

#include "volume/device_volume.h"

namespace chiaro {

/// The ranges of the brick's 4³ cells, each over the voxels that samples inside it can touch: its 5³ and `margin` more
/// on each side. Of the brick's slices so many are there.
template <class Device, int margin = 0>
void fill_cells(const Device* brick, std::array<int, 3> at, int slices, CellRanges& cells) {
    constexpr int per_brick = brick_edge / cell_edge, edge = cell_edge + 1 + 2 * margin, before = brick_before - margin;
    for (int c = 0; c < per_brick * per_brick * per_brick; ++c) {
        const int cx = c % per_brick, cy = c / per_brick % per_brick, cz = c / (per_brick * per_brick);
        const int x = at[0] * per_brick + cx, y = at[1] * per_brick + cy, z = at[2] * per_brick + cz;
        if (x >= cells.count[0] || y >= cells.count[1] || z >= cells.count[2]) continue;
        const Device* corner =
            brick + (cz * cell_edge + before) * brick_slice + (cy * cell_edge + before) * brick_row + cx * cell_edge + before;
        const int depth = std::min(edge, slices - cz * cell_edge - before);
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
        const std::size_t cell = (std::size_t(z) * cells.count[1] + y) * cells.count[0] + x;
        cells.low[cell] = float(*std::min_element(low, low + edge));
        cells.high[cell] = float(*std::max_element(high, high + edge));
    }
}

}  // namespace chiaro

// The value ranges of a brick's cells.
#pragma once
#include <algorithm>
#include <array>

#include "volume/device_volume.h"

namespace chiaro {

/// The ranges of the brick's 4³ cells, each over the 9³ voxels that samples inside it can touch.
template <class Device>
void fill_cells(const Device* brick, std::array<int, 3> at, CellRanges& cells) {
    constexpr int per_brick = brick_edge / cell_edge;
    for (int c = 0; c < per_brick * per_brick * per_brick; ++c) {
        const int cx = c % per_brick, cy = c / per_brick % per_brick, cz = c / (per_brick * per_brick);
        const int x = at[0] * per_brick + cx, y = at[1] * per_brick + cy, z = at[2] * per_brick + cz;
        if (x >= cells.count[0] || y >= cells.count[1] || z >= cells.count[2]) continue;
        const Device* corner =
            brick + (cz * cell_edge + 1) * brick_slice + (cy * cell_edge + 1) * brick_row + cx * cell_edge + 1;
        // Columns side by side first: the compiler turns the inner loop into vector minima.
        Device low[cell_edge + 1], high[cell_edge + 1];
        std::copy_n(corner, cell_edge + 1, low);
        std::copy_n(corner, cell_edge + 1, high);
        for (int k = 0; k <= cell_edge; ++k)
            for (int j = 0; j <= cell_edge; ++j)
                for (int i = 0; i <= cell_edge; ++i) {
                    const Device v = corner[k * brick_slice + j * brick_row + i];
                    low[i] = std::min(low[i], v);
                    high[i] = std::max(high[i], v);
                }
        const std::size_t cell = (std::size_t(z) * cells.count[1] + y) * cells.count[0] + x;
        cells.low[cell] = float(*std::min_element(low, low + cell_edge + 1));
        cells.high[cell] = float(*std::max_element(high, high + cell_edge + 1));
    }
}

}  // namespace chiaro

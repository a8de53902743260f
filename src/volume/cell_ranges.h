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

/// The smallest and largest of so many rows of `width` numbers, element by element: what the compiler turns into
/// vectors.
template <int width, class Device>
void range_of_rows(const Device* lows, const Device* highs, int stride, int rows, Device* low, Device* high) {
    std::copy_n(lows, width, low);
    std::copy_n(highs, width, high);
    for (int r = 1; r < rows; ++r)
        for (int i = 0; i < width; ++i) {
            low[i] = std::min(low[i], lows[r * stride + i]);
            high[i] = std::max(high[i], highs[r * stride + i]);
        }
}

/// The ranges of the brick's cells, each over the voxels that samples inside it can touch: its 5³ and `margin` more on
/// each side. Of the brick's slices so many are there. Axis by axis: a layer of cells' slices, its rows, their columns.
template <class Device, int margin = 0>
void fill_cells(const Device* brick, std::array<int, 3> at, int slices, CellRanges& cells) {
    constexpr int edge = cell_edge + 1 + 2 * margin, per_brick = brick_edge / cell_edge, first = brick_before - margin;
    const auto count = [&](int axis) { return std::min(per_brick, cells.count[axis] - at[axis] * per_brick); };
    Device low_slice[brick_slice], high_slice[brick_slice], low[brick_row], high[brick_row];
    Device low_row[brick_row + edge] = {}, high_row[brick_row + edge] = {};  // read beyond their end
    for (int z = 0; z < count(2); ++z) {
        const Device* slice = brick + (z * cell_edge + first) * brick_slice;
        range_of_rows<brick_slice>(slice, slice, brick_slice, std::min(edge, slices - z * cell_edge - first), low_slice,
                                   high_slice);
        for (int y = 0; y < count(1); ++y) {
            const int row = (y * cell_edge + first) * brick_row;
            range_of_rows<brick_row>(low_slice + row, high_slice + row, brick_row, edge, low_row, high_row);
            range_of_rows<brick_row>(low_row, high_row, 1, edge, low, high);
            const std::size_t cell =
                (std::size_t(at[2] * per_brick + z) * cells.count[1] + at[1] * per_brick + y) * cells.count[0] +
                at[0] * per_brick;
            for (int x = 0; x < count(0); ++x) {
                cells.low[cell + x] = float(low[x * cell_edge + first]);
                cells.high[cell + x] = float(high[x * cell_edge + first]);
            }
        }
    }
}

}  // namespace chiaro

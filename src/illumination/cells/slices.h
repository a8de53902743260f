// Rows of a grid's cells, of which all slices or the last few are in memory, and the cells around a block of them.
#pragma once
#include "illumination/cells/grid.h"

namespace chiaro {

/// Row (y, z) of a grid; of its slices at least the last `held` ones that were written are there.
template <class Cell>
struct RowsOf {
    std::array<int, 3> count{0, 0, 0};
    Cell* cells = nullptr;
    int held = 1;

    Cell* row(int y, int z) const { return cells + (std::size_t(z % held) * count[1] + y) * count[0]; }
    bool holds_all() const { return held >= count[2]; }
    operator RowsOf<const Cell>() const { return {count, cells, held}; }
};
using CellRows = RowsOf<const std::uint16_t>;

inline CellRows rows_of(const std::array<int, 3>& count, const std::uint16_t* cells) {
    return {count, cells, count[2]};
}
inline CellRows rows_of(const CellValues& values) { return rows_of(values.grid.count, values.data()); }
inline RowsOf<std::uint16_t> rows_of(CellValues& values) {
    return {values.grid.count, values.data(), values.grid.count[2]};
}

/// Memory for some slices of a grid that is gone through from its first to its last: the next takes the place of the
/// oldest. (Memory that was given back and taken again costs more than what is done with it.)
class SliceRing {
public:
    SliceRing(const std::array<int, 3>& count, int slices)
        : count_(count),
          held_(std::min(slices, count[2])),
          buffer_((std::size_t(held_) * count[0] * count[1] + CellValues::spare) * sizeof(std::uint16_t)) {}
    RowsOf<std::uint16_t> rows() { return {count_, reinterpret_cast<std::uint16_t*>(buffer_.data()), held_}; }

private:
    std::array<int, 3> count_;
    int held_;
    VoxelBuffer buffer_;
};

/// A block's cells and two around them, laid out as kernel::CellTile. Beyond the grid lies nothing: 0.
void load_tile(const CellRows& from, const std::array<int, 3>& first, std::uint16_t* tile);

}  // namespace chiaro

#include "illumination/cells/slices.h"

#include <cstring>

#include "illumination/cells/block_place.h"

namespace chiaro {
namespace {

using Tile = kernel::CellTile;
constexpr int halo = Tile::halo, row_cells = Tile::row;

/// A row that reaches beyond the grid's first or last cell.
void load_cut_row(const std::uint16_t* row, int nx, int x0, std::uint16_t* to) {
    const int begin = std::clamp(-x0, 0, row_cells), end = std::clamp(nx - x0, begin, row_cells);
    std::fill_n(to, begin, std::uint16_t(0));
    std::copy(row + x0 + begin, row + x0 + end, to + begin);
    std::fill(to + end, to + row_cells, std::uint16_t(0));
}

}  // namespace

void load_tile(const CellRows& from, const std::array<int, 3>& first, std::uint16_t* tile) {
    const auto [nx, ny, nz] = from.count;
    const int x0 = first[0] - halo;
    const bool is_whole = x0 >= 0 && x0 + row_cells <= nx;
    for (int k = 0; k < row_cells; ++k)
        for (int j = 0; j < row_cells; ++j, tile += row_cells) {
            const int y = first[1] - halo + j, z = first[2] - halo + k;
            if (y < 0 || y >= ny || z < 0 || z >= nz) {
                std::memset(tile, 0, row_cells * sizeof *tile);
                continue;
            }
            const std::uint16_t* row = from.row(y, z);
            // Rows lie too far apart for the processor to guess the next one: a slice ahead.
            const std::uint16_t* ahead = from.row(y, std::min(z + 1, nz - 1)) + std::max(x0, 0);
            __builtin_prefetch(ahead), __builtin_prefetch(ahead + row_cells - 1);
            if (is_whole)  // a size that the compiler knows: no call
                std::memcpy(tile, row + x0, row_cells * sizeof *tile);
            else
                load_cut_row(row, nx, x0, tile);
        }
}

}  // namespace chiaro

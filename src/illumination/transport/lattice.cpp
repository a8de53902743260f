#include "illumination/transport/lattice.h"

#include <algorithm>

namespace chiaro {
namespace {

constexpr int tile = 16;

}  // namespace

/// Rows of the one are columns of the other: tile by tile, each line of memory taken and left once as a whole, for the
/// rows along y of a slice may all fall into one set of the cache.
void copy_slice(const Lattice& from, const float* source, const Lattice& to, float* target, int z) {
    const auto [nx, ny, nz] = from.count();
    const int rows = from.along_y() ? nx : ny, columns = from.along_y() ? ny : nx;
    const std::size_t step_from = from.along_y() ? from.index(1, 0, 0) : from.index(0, 1, 0),
                      step_to = to.along_y() ? to.index(1, 0, 0) : to.index(0, 1, 0);
    source += from.index(0, 0, z), target += to.index(0, 0, z);
    float lines[tile][tile];
    for (int r = 0; r < rows; r += tile)
        for (int c = 0; c < columns; c += tile) {
            // Both fields' rows are padded to whole tiles.
            const int down = std::min(tile, rows - r), across = std::min(tile, columns - c);
            for (int i = 0; i < down; ++i) std::copy_n(source + (r + i) * step_from + c, tile, lines[i]);
            for (int i = down; i < tile; ++i) std::fill_n(lines[i], tile, 0.0f);
            for (int j = 0; j < across; ++j)
                for (int i = 0; i < tile; ++i) target[(c + j) * step_to + r + i] = lines[i][j];
        }
}

LatticeField spread(const CellGrid& grid, const float* values, const Lattice& lattice) {
    LatticeField field = lattice.field();
    for (int z = 0; z < grid.count[2]; ++z)
        for (int y = 0; y < grid.count[1]; ++y)
            for (int x = 0; x < grid.count[0]; ++x) field[lattice.index(x, y, z)] = values[grid.index(x, y, z)];
    return field;
}

}  // namespace chiaro

#include "illumination/transport/lattice.h"

namespace chiaro {
namespace {

constexpr int tile = 16;

}  // namespace

void copy_slice(const Lattice& from, const float* source, const Lattice& to, float* target, int z) {
    const auto [nx, ny, nz] = from.count();
    // Rows along x in the one are rows along y in the other: tile by tile, so that both stay in the cache.
    for (int y0 = 0; y0 < ny; y0 += tile)
        for (int x0 = 0; x0 < nx; x0 += tile) {
            const float* a = source + from.index(x0, y0, z);
            float* b = target + to.index(x0, y0, z);
            const std::size_t ax = from.index(1, 0, 0), ay = from.index(0, 1, 0), bx = to.index(1, 0, 0),
                              by = to.index(0, 1, 0);
            const int across = std::min(tile, nx - x0), down = std::min(tile, ny - y0);
            if (by == 1)
                for (int x = 0; x < across; ++x)
                    for (int y = 0; y < down; ++y) b[x * bx + y] = a[x * ax + y * ay];
            else
                for (int y = 0; y < down; ++y)
                    for (int x = 0; x < across; ++x) b[x * bx + y * by] = a[x * ax + y * ay];
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

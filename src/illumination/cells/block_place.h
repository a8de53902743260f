// A block of cells as a GPU's threads are told of it.
#pragma once
#include <cstdint>

#include "kernel/lanes.h"

namespace chiaro::kernel {

struct BlockPlace {
    static constexpr int edge = 32, cells = edge * edge * edge, width = 16, height = 4;
    std::int32_t first[3];                              ///< cell or corner
    std::uint8_t pieces[edge / height][edge / height];  ///< that are asked for: bit x of [z][y], 16 × 4 × 4 each
};

/// A block's cells and two around them.
struct CellTile {
    static constexpr int edge = BlockPlace::edge, halo = 2, row = edge + 2 * halo, slice = row * row,
                         size = slice * row;
};

/// Whether the piece around a cell of a block is asked for.
CHIARO_INLINE bool is_asked(const std::uint8_t (*pieces)[BlockPlace::edge / BlockPlace::height], std::int32_t x,
                            std::int32_t y, std::int32_t z) {
    return pieces[z / BlockPlace::height][y / BlockPlace::height] >> (x / BlockPlace::width) & 1;
}

/// Whether any piece of a slice of a block is.
CHIARO_INLINE bool any_asked(const std::uint8_t (*pieces)[BlockPlace::edge / BlockPlace::height], std::int32_t z) {
    for (std::int32_t y = 0; y < BlockPlace::edge / BlockPlace::height; ++y)
        if (pieces[z / BlockPlace::height][y]) return true;
    return false;
}
/// A piece's cells of a row, from its cell x of `nx` on; the last may be cut.
CHIARO_INLINE void store_piece(const std::uint16_t (&found)[BlockPlace::width], std::int32_t x, std::int32_t nx,
                               std::uint16_t* to) {
    if (x + BlockPlace::width <= nx)
        __builtin_memcpy(to, found, sizeof found);
    else
        for (std::int32_t i = x; i < nx; ++i) to[i - x] = found[i - x];
}

/// One of the items of blocks side by side, `size` each.
struct BlockShare {
    std::uint32_t block;
    std::int32_t i;
    CHIARO_INLINE BlockShare(std::int64_t item, std::int32_t size)
        : block(std::uint32_t(item) / std::uint32_t(size)), i(std::int32_t(item - std::int64_t(block) * size)) {}
};

/// The same of a size known when compiling: rows of so many, the first of all `halo` cells before its block.
template <int row, int halo, int size>
struct BlockItem {
    const BlockPlace& place;
    std::int64_t block;
    std::int32_t i;  ///< in the block

    CHIARO_INLINE BlockItem(const BlockPlace* places, std::int64_t item)
        : place(places[item / size]), block(item / size), i(std::int32_t(item % size)) {}

    CHIARO_INLINE std::int32_t x() const { return i % row; }
    CHIARO_INLINE std::int32_t y() const { return i / row % row; }
    CHIARO_INLINE std::int32_t z() const { return i / row / row; }
    CHIARO_INLINE std::int32_t grid_x() const { return place.first[0] - halo + x(); }
    CHIARO_INLINE std::int32_t grid_y() const { return place.first[1] - halo + y(); }
    CHIARO_INLINE std::int32_t grid_z() const { return place.first[2] - halo + z(); }
    CHIARO_INLINE bool is_asked() const { return kernel::is_asked(place.pieces, x(), y(), z()); }
};
using BlockCell = BlockItem<BlockPlace::edge, 0, BlockPlace::cells>;

}  // namespace chiaro::kernel

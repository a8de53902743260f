// Stored levels and coarser grids: mipmaps and N-buffers of rows, in plain loops that the compiler turns into vectors,
// or of single cells.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

/// Means of 2 × 2 × 2 cells: four rows of 2 n cells give one of n.
struct MipRows {
    const std::uint16_t* from[4];
};
/// From two neighbours in each of four rows.
CHIARO_INLINE std::uint16_t mip_cell(const std::uint16_t* a, const std::uint16_t* b, const std::uint16_t* c,
                                     const std::uint16_t* d) {
    const int even = a[0] + b[0] + c[0] + d[0], odd = a[1] + b[1] + c[1] + d[1];
    return std::uint16_t((even + odd + 4) >> 3);
}
CHIARO_INLINE void mip_row(const MipRows& rows, int n, std::uint16_t* to) {
    const std::uint16_t *a = rows.from[0], *b = rows.from[1], *c = rows.from[2], *d = rows.from[3];
    for (int i = 0; i < n; ++i) to[i] = mip_cell(a + 2 * i, b + 2 * i, c + 2 * i, d + 2 * i);
}

/// What crosses 2 × 2 × 2 cells: along each axis the mean over its four columns of the product of their two cells'
/// transparencies, and of the three axes the least; as opacity. A wall stays a wall, a clump leaves its gaps open.
CHIARO_INLINE std::uint16_t crossing_cell(const std::uint16_t* a, const std::uint16_t* b, const std::uint16_t* c,
                                          const std::uint16_t* d) {
    const auto clear = [](std::uint16_t opacity) CHIARO_INLINE_LAMBDA { return 1 - opacity * (1 / 65535.0f); };
    const float a0 = clear(a[0]), a1 = clear(a[1]), b0 = clear(b[0]), b1 = clear(b[1]);
    const float c0 = clear(c[0]), c1 = clear(c[1]), d0 = clear(d[0]), d1 = clear(d[1]);
    const float x = a0 * a1 + b0 * b1 + c0 * c1 + d0 * d1;
    const float y = a0 * b0 + a1 * b1 + c0 * d0 + c1 * d1;
    const float z = a0 * c0 + a1 * c1 + b0 * d0 + b1 * d1;
    return std::uint16_t(std::int32_t((1 - 0.25f * min(x, min(y, z))) * 65535 + 0.5f));
}
CHIARO_INLINE void crossing_row(const MipRows& rows, int n, std::uint16_t* to) {
    const std::uint16_t *a = rows.from[0], *b = rows.from[1], *c = rows.from[2], *d = rows.from[3];
    for (int i = 0; i < n; ++i) to[i] = crossing_cell(a + 2 * i, b + 2 * i, c + 2 * i, d + 2 * i);
}

/// What a corner is worth: twice the transparency of the 8 finest cells around it, at most 1, at least 1/512.
CHIARO_INLINE std::uint16_t corner_weight(std::uint16_t opacity) {
    return std::uint16_t(max(128, min(2 * (65535 - opacity), 65535)));
}

/// Opacities of a grid's cells, as 65535ths; x fastest.
struct OpacityGrid {
    std::int32_t count[3];
    const std::uint16_t* cells;

    CHIARO_INLINE const std::uint16_t* row(int y, int z) const {
        return cells + (std::int64_t(z) * count[1] + y) * count[0];
    }
    /// Beyond the grid lies nothing.
    CHIARO_INLINE std::uint16_t at(int x, int y, int z) const {
        const bool inside = x >= 0 && x < count[0] && y >= 0 && y < count[1] && z >= 0 && z < count[2];
        return inside ? row(y, z)[x] : 0;
    }
};
/// The 2 × 2 × 2 cells from one on, in four rows.
struct EightCells {
    std::uint16_t row[4][2];
    CHIARO_INLINE EightCells(const OpacityGrid& grid, int x, int y, int z) {
        for (int r = 0; r < 4; ++r)
            for (int i = 0; i < 2; ++i) row[r][i] = grid.at(x + i, y + (r & 1), z + (r >> 1));
    }
    CHIARO_INLINE std::uint16_t mean() const { return mip_cell(row[0], row[1], row[2], row[3]); }
    CHIARO_INLINE std::uint16_t crossing() const { return crossing_cell(row[0], row[1], row[2], row[3]); }
};

/// Weights of every other corner of a finer grid, which may end sooner.
struct EveryOther {
    const std::uint16_t* finer;
    std::int32_t count[3];
    CHIARO_INLINE std::uint16_t at(int x, int y, int z) const {
        const bool inside = 2 * x < count[0] && 2 * y < count[1] && 2 * z < count[2];
        return inside ? finer[(std::int64_t(2 * z) * count[1] + 2 * y) * count[0] + 2 * x] : std::uint16_t(65535);
    }
};

/// Mean rounded down, so that one half of the roundings cancels the other.
CHIARO_INLINE std::uint16_t mean_below(std::uint16_t a, std::uint16_t b) {
    return std::uint16_t(mean_of(a, b) - ((a ^ b) & 1));
}

/// The four rows of a level that lie at a row of the next, y and z, each near and far.
struct NBufferRows {
    const std::uint16_t* from[4];
    std::int32_t n;         ///< cells in each
    std::int32_t distance;  ///< 2^(l-1)
};
/// B_l[i] = mean of the 8 values B_(l-1)[i + {0, 2^(l-1)}³]; the row of n + distance cells begins `distance` cells
/// before the rows that it is made of. `scratch` holds n + 2 distance cells, the first and last `distance` of them 0.
CHIARO_INLINE std::uint16_t nbuffer_mean(std::uint16_t a, std::uint16_t b, std::uint16_t c, std::uint16_t d) {
    return mean_below(mean_of(a, b), mean_of(c, d));
}
CHIARO_INLINE void nbuffer_row(const NBufferRows& rows, std::uint16_t* scratch, std::uint16_t* to) {
    const std::uint16_t *a = rows.from[0], *b = rows.from[1], *c = rows.from[2], *d = rows.from[3];
    std::uint16_t* middle = scratch + rows.distance;
    for (int i = 0; i < rows.n; ++i) middle[i] = nbuffer_mean(a[i], b[i], c[i], d[i]);
    for (int i = 0; i < rows.n + rows.distance; ++i) to[i] = mean_of(scratch[i], middle[i]);
}
/// The same for one cell of the next level.
CHIARO_INLINE std::uint16_t nbuffer_cell(const OpacityGrid& from, int distance, int x, int y, int z) {
    const auto middle = [&](int i) CHIARO_INLINE_LAMBDA {
        return nbuffer_mean(from.at(i, y - distance, z - distance), from.at(i, y, z - distance),
                            from.at(i, y - distance, z), from.at(i, y, z));
    };
    return mean_of(middle(x - distance), middle(x));
}

}  // namespace chiaro::kernel

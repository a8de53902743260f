// Rows of the stored levels: mipmaps and N-buffers, in plain loops that the compiler turns into vectors.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

/// Means of 2 × 2 × 2 cells: four rows of 2 n cells give one of n.
struct MipRows {
    const std::uint16_t* from[4];
};
CHIARO_INLINE void mip_row(const MipRows& rows, int n, std::uint16_t* to) {
    const std::uint16_t *a = rows.from[0], *b = rows.from[1], *c = rows.from[2], *d = rows.from[3];
    for (int i = 0; i < n; ++i) {
        const int even = a[2 * i] + b[2 * i] + c[2 * i] + d[2 * i];
        const int odd = a[2 * i + 1] + b[2 * i + 1] + c[2 * i + 1] + d[2 * i + 1];
        to[i] = std::uint16_t((even + odd + 4) >> 3);
    }
}

/// What crosses 2 × 2 × 2 cells: along each axis the mean over its four columns of the product of their two cells'
/// transparencies, and of the three axes the least; as opacity. A wall stays a wall, a clump leaves its gaps open.
CHIARO_INLINE void crossing_row(const MipRows& rows, int n, std::uint16_t* to) {
    const std::uint16_t *a = rows.from[0], *b = rows.from[1], *c = rows.from[2], *d = rows.from[3];
    const auto clear = [](std::uint16_t opacity) CHIARO_INLINE_LAMBDA { return 1 - opacity * (1 / 65535.0f); };
    for (int i = 0; i < n; ++i) {
        const float a0 = clear(a[2 * i]), a1 = clear(a[2 * i + 1]), b0 = clear(b[2 * i]), b1 = clear(b[2 * i + 1]);
        const float c0 = clear(c[2 * i]), c1 = clear(c[2 * i + 1]), d0 = clear(d[2 * i]), d1 = clear(d[2 * i + 1]);
        const float x = a0 * a1 + b0 * b1 + c0 * c1 + d0 * d1;
        const float y = a0 * b0 + a1 * b1 + c0 * d0 + c1 * d1;
        const float z = a0 * c0 + a1 * c1 + b0 * d0 + b1 * d1;
        to[i] = std::uint16_t(std::int32_t((1 - 0.25f * min(x, min(y, z))) * 65535 + 0.5f));
    }
}

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
CHIARO_INLINE void nbuffer_row(const NBufferRows& rows, std::uint16_t* scratch, std::uint16_t* to) {
    const std::uint16_t *a = rows.from[0], *b = rows.from[1], *c = rows.from[2], *d = rows.from[3];
    std::uint16_t* middle = scratch + rows.distance;
    for (int i = 0; i < rows.n; ++i) middle[i] = mean_below(mean_of(a[i], b[i]), mean_of(c[i], d[i]));
    for (int i = 0; i < rows.n + rows.distance; ++i) to[i] = mean_of(scratch[i], middle[i]);
}

}  // namespace chiaro::kernel

// Halving the density of a block: rows of 2 n cells become one of n nodes.
#pragma once
#include "kernel/math.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// T = exp(-κ) of `count` cells, a multiple of 16.
template <class F>
CHIARO_INLINE void transmittance_row(const float* depth, std::int32_t count, float* to) {
    for (std::int32_t x = 0; x < count; x += LaneTraits<F>::count)
        store_row(to + x, exp2(load_row<F>(depth + x) * F(-1.442695041f)));
}

/// Rows of transmittance side by side: (y, z) = (0, 0), (1, 0), (0, 1), (1, 1).
struct FourRows {
    const float* at[4];
};

inline constexpr std::int32_t max_nodes = 16;  ///< of a row

/// Transmittance of the four columns of 2 cells along each axis, added up.
struct ColumnSums {
    float along[3][max_nodes];
};
CHIARO_INLINE void add_columns(const FourRows& rows, std::int32_t nodes, ColumnSums& sums) {
    const float *a = rows.at[0], *b = rows.at[1], *c = rows.at[2], *d = rows.at[3];
    for (std::int32_t x = 0; x < nodes; ++x) {
        const float a0 = a[2 * x], a1 = a[2 * x + 1], b0 = b[2 * x], b1 = b[2 * x + 1], c0 = c[2 * x],
                    c1 = c[2 * x + 1], d0 = d[2 * x], d1 = d[2 * x + 1];
        sums.along[0][x] = (a0 * a1 + b0 * b1) + (c0 * c1 + d0 * d1);
        sums.along[1][x] = (a0 * b0 + a1 * b1) + (c0 * d0 + c1 * d1);
        sums.along[2][x] = (a0 * c0 + a1 * c1) + (b0 * d0 + b1 * d1);
    }
}

/// κ = -ln of the geometric mean over the axes of the columns' mean transmittance, of up to 16 nodes.
template <class F>
CHIARO_INLINE void halve_row(const FourRows& rows, std::int32_t nodes, float* to) {
    ColumnSums sums{};
    add_columns(rows, nodes, sums);
    float depth[max_nodes];
    for (std::int32_t x = 0; x < nodes; x += LaneTraits<F>::count) {
        // κ stays finite: at most 87
        const auto log_of = [&](int axis) CHIARO_INLINE_LAMBDA {
            return log2(max(load_row<F>(sums.along[axis] + x) * F(0.25f), F(1e-38f)));
        };
        store_row(depth + x, max((log_of(0) + log_of(1) + log_of(2)) * F(-0.2310490602f), F(0)));
    }
    for (std::int32_t x = 0; x < nodes; ++x) to[x] = depth[x];
}

struct DensityRows {
    void (*transmittance)(const float* depth, std::int32_t count, float* to);
    void (*halve)(const FourRows&, std::int32_t nodes, float* to);
};

}  // namespace chiaro::kernel

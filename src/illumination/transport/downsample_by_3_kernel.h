// Density of nodes that stand for 3³ finer ones: one item a node.
#pragma once
#include <cmath>

#include "kernel/lanes.h"

namespace chiaro::kernel {

/// As halving (visibility/rows.h): T the geometric mean over the axes of the mean transmittance of the nine columns.
struct DownsampleBy3Kernel {
    const float* finer;
    std::int32_t fine[3];  ///< finer nodes per axis
    float* to;
    std::int32_t nx, ny;

    CHIARO_INLINE void operator()(std::int64_t node) const {
        const std::int32_t x = std::int32_t(node % nx), y = std::int32_t(node / nx % ny),
                           z = std::int32_t(node / nx / ny);
        double column[3][9]{}, sum[3]{};
        for (int c = 0; c < 3; ++c)
            for (int b = 0; b < 3; ++b)
                for (int a = 0; a < 3; ++a) {
                    const double d = depth(3 * x + a, 3 * y + b, 3 * z + c);
                    column[0][3 * c + b] += d, column[1][3 * c + a] += d, column[2][3 * b + a] += d;
                }
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < 9; ++i) sum[axis] += ::exp(-column[axis][i]) / 9;
        const double open = sum[0] * sum[1] * sum[2];
        to[node] = float(-::log(open < 1e-110 ? 1e-110 : open > 1 ? 1 : open) / 3);
    }

private:
    CHIARO_INLINE float depth(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const bool inside = x < fine[0] && y < fine[1] && z < fine[2];
        return inside ? finer[(std::int64_t(z) * fine[1] + y) * fine[0] + x] : 0.0f;
    }
};

}  // namespace chiaro::kernel

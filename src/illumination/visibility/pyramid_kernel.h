// The levels of the pyramid, one item a node.
#pragma once
#include <cmath>

#include "illumination/cells/cell_kernel.h"

namespace chiaro::kernel {

/// exp(-κ)
struct FinestLevel {
    const float* depth;
    std::uint16_t* to;

    CHIARO_INLINE void operator()(std::int64_t node) const { to[node] = share_value(::exp(-double(depth[node]))); }
};

/// (mean of the 8 below)²; missing ones are open.
struct NextLevel {
    const std::uint16_t* from;
    std::int32_t finer[3];  ///< nodes per axis
    std::uint16_t* to;
    std::int32_t nx, ny;

    CHIARO_INLINE void operator()(std::int64_t node) const {
        const std::int32_t x = std::int32_t(node % nx), y = std::int32_t(node / nx % ny),
                           z = std::int32_t(node / nx / ny);
        std::int32_t sum = 0;
        for (std::int32_t i = 0; i < 8; ++i) sum += below(2 * x + (i & 1), 2 * y + (i >> 1 & 1), 2 * z + (i >> 2));
        const double mean = sum / (8.0 * 65535);
        to[node] = share_value(mean * mean);
    }

private:
    CHIARO_INLINE std::int32_t below(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (x >= finer[0] || y >= finer[1] || z >= finer[2]) return 65535;
        return from[(std::int64_t(z) * finer[1] + y) * finer[0] + x];
    }
};

}  // namespace chiaro::kernel

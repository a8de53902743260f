// Cells' bins as kernels read them, and where they rise.
#pragma once
#include "kernel/vec.h"

namespace chiaro::kernel {

struct BinGrid {
    const std::uint16_t* bins;  ///< x fastest
    std::int32_t count[3];

    CHIARO_INLINE bool holds(int x, int y, int z) const {
        return x >= 0 && y >= 0 && z >= 0 && x < count[0] && y < count[1] && z < count[2];
    }
    CHIARO_INLINE const std::uint16_t* cell(int x, int y, int z) const {
        return bins + (std::int64_t(z) * count[1] + y) * count[0] + x;
    }
    /// ∇f, bins per cell edge: differences of the neighbours, one-sided at the border; any cell of the grid.
    CHIARO_INLINE Float3 gradient(int x, int y, int z) const {
        const std::uint16_t* here = cell(x, y, z);
        const std::int64_t row = count[0], slice = row * count[1];
        const auto along = [&](int at, int n, std::int64_t step) CHIARO_INLINE_LAMBDA {
            return 0.5f * float(int(here[at + 1 < n ? step : 0]) - int(here[at > 0 ? -step : 0]));
        };
        return {along(x, count[0], 1), along(y, count[1], row), along(z, count[2], slice)};
    }
    /// ∇f of length 1, or 0 where there is none.
    CHIARO_INLINE Float3 normal(int x, int y, int z) const {
        const Float3 g = gradient(x, y, z);
        const float length = sqrt(g.x * g.x + g.y * g.y + g.z * g.z);
        if (!(length > 0)) return {0, 0, 0};
        return {g.x / length, g.y / length, g.z / length};
    }
};

}  // namespace chiaro::kernel

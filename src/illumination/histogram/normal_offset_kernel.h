// Identifiers that a picture looks up: those of the node one further outwards.
#pragma once
#include "illumination/histogram/bin_grid.h"

namespace chiaro::kernel {

/// Forward from the node one further along ∇f, backward from the one before, where the gradient there is much the same.
struct NormalOffsetKernel {
    BinGrid cells;
    const std::uint16_t* codewords;  ///< forward and backward of each node, x fastest
    std::uint16_t* displaced;
    std::int32_t nodes[3], step;  ///< cells from one node to the next

    CHIARO_INLINE void operator()(std::int64_t, int x, int y, int z) const {
        const Float3 n = normal(x, y, z);
        const int dx = whole(n.x), dy = whole(n.y), dz = whole(n.z);
        for (const int half : {0, 1}) {
            const int side = half == 0 ? 1 : -1, i = x + side * dx, j = y + side * dy, k = z + side * dz;
            const bool is_alike = i >= 0 && j >= 0 && k >= 0 && i < nodes[0] && j < nodes[1] && k < nodes[2] &&
                                  (dx != 0 || dy != 0 || dz != 0) && cosine(n, normal(i, j, k)) >= 0.5f;
            displaced[at(x, y, z) + half] = codewords[(is_alike ? at(i, j, k) : at(x, y, z)) + half];
        }
    }

private:
    CHIARO_INLINE std::int64_t at(int x, int y, int z) const {
        return 2 * ((std::int64_t(z) * nodes[1] + y) * nodes[0] + x);
    }
    CHIARO_INLINE Float3 normal(int x, int y, int z) const { return cells.normal(x * step, y * step, z * step); }
    static CHIARO_INLINE float cosine(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    /// The nearest whole number to one in [-1, 1].
    static CHIARO_INLINE int whole(float a) { return a >= 0.5f ? 1 : a <= -0.5f ? -1 : 0; }
};

}  // namespace chiaro::kernel

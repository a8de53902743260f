// What of a ray is marched, where that is known before; and where in a pixel its rays lie.
#pragma once
#include "kernel/gather.h"
#include "raycast/lattice.h"

namespace chiaro::kernel {

inline constexpr std::int32_t tile_edge = 32;  ///< pixels

/// Nearest entry and farthest exit in mm for each pixel of a tile, one layer for each ray of a pixel.
struct BoundsView {
    const float* near_mm;  ///< null: nothing is known
    const float* far_mm;
    std::int32_t x0, y0;

    /// Leaves the steps from the one before the entry to the one behind the exit: what rounding could move.
    template <class F>
    CHIARO_INLINE void narrow(Int<F> column, Int<F> row, std::int32_t layer, F lattice_near_mm, float step_mm,
                              Lattice<F>& lattice) const {
        const Int<F> at =
            Int<F>(layer * tile_edge * tile_edge) + (row - Int<F>(y0)) * Int<F>(tile_edge) + column - Int<F>(x0);
        const F first = floor((gather_float(near_mm, at) - lattice_near_mm) * F(1 / step_mm)) - F(1);
        const F end = floor((gather_float(far_mm, at) - lattice_near_mm) * F(1 / step_mm)) + F(2);
        lattice.first = max(first, F(0));
        lattice.end = min(end, lattice.end);
    }
};

/// Where ray i of n passes its pixel, from the middle: Hammersley's points, (i + ½) / n and i's binary digits reversed.
struct SubPixel {
    float x, y;
};
CHIARO_INLINE SubPixel sub_pixel(std::int32_t i, std::int32_t n) {
    float y = 0.5f / float(n), digit = 0.5f;
    for (std::int32_t rest = i; rest > 0; rest >>= 1, digit *= 0.5f)
        if (rest & 1) y += digit;
    return {(float(i) + 0.5f) / float(n) - 0.5f, (y < 1 ? y : y - 1) - 0.5f};
}

}  // namespace chiaro::kernel

// From an image to kernel calls: one call per pixel, or per 4 × 4 block of pixels where the lanes are sixteen.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// What an image kernel is called with.
template <class F>
struct PixelBlock {
    std::int32_t x, y;   ///< first pixel
    Int<F> column, row;  ///< of every lane
    Mask<F> inside;      ///< lanes within the image
};

/// Pixels [x0, x1) × [y0, y1).
struct Tile {
    std::int32_t x0, y0, x1, y1;
};

template <class F>
struct BlockShape;
template <>
struct BlockShape<float> {
    static constexpr std::int32_t edge = 1;
    static CHIARO_INLINE std::int32_t column() { return 0; }
    static CHIARO_INLINE std::int32_t row() { return 0; }
};
CHIARO_INLINE std::int64_t sum(std::int32_t a) { return a; }

#ifdef CHIARO_SIMD
template <>
struct BlockShape<Lanes> {
    static constexpr std::int32_t edge = 4;
    static CHIARO_INLINE IntLanes load(const std::int32_t (&values)[16]) {
        IntLanes lanes;
        __builtin_memcpy(&lanes, values, sizeof lanes);
        return lanes;
    }
    static CHIARO_INLINE IntLanes column() { return load({0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3}); }
    static CHIARO_INLINE IntLanes row() { return load({0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3}); }
};
inline namespace CHIARO_ISA {
CHIARO_INLINE std::int64_t sum(IntLanes a) {
    std::int32_t values[16];
    __builtin_memcpy(values, &a, sizeof values);
    std::int64_t total = 0;
    for (std::int32_t v : values) total += v;
    return total;
}
}  // namespace CHIARO_ISA
using NativeLanes = Lanes;
#else
using NativeLanes = float;
#endif

template <class F>
CHIARO_INLINE PixelBlock<F> pixel_block(std::int32_t x, std::int32_t y, std::int32_t x1, std::int32_t y1) {
    const Int<F> column = Int<F>(x) + BlockShape<F>::column(), row = Int<F>(y) + BlockShape<F>::row();
    return {x, y, column, row, Mask<F>((column < Int<F>(x1)) & (row < Int<F>(y1)))};
}

/// Calls the kernel for every pixel of the tile; returns the sum of what the calls return.
template <class F, class Kernel>
std::int64_t run_tile(const Kernel& kernel, Tile tile) {
    std::int64_t total = 0;
    for (std::int32_t y = tile.y0; y < tile.y1; y += BlockShape<F>::edge)
        for (std::int32_t x = tile.x0; x < tile.x1; x += BlockShape<F>::edge)
            total += sum(kernel(pixel_block<F>(x, y, tile.x1, tile.y1)));
    return total;
}

}  // namespace chiaro::kernel

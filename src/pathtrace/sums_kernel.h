// What is told of a frame's sums.
#pragma once
#include "pathtrace/pixel_sum.h"

namespace chiaro::kernel {

/// A pixel of the frame: the mean of its paths.
struct MeanKernel {
    const PixelSum* sums;
    Rgba* pixels;
    double share;  ///< 1 / paths

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const PixelSum& sum = sums[i];
        pixels[i] = {float(share * sum.r), float(share * sum.g), float(share * sum.b), float(share * sum.a)};
    }
};

/// Squares, summed over pixels and averaged over channels.
struct PathNoise {
    double errors = 0;  ///< of the mean: its standard error's
    double light = 0;   ///< the mean's
};

/// A run of pixels: an item each, so that what comes back from a GPU is little.
struct NoiseKernel {
    static constexpr std::int64_t run = 128;
    static constexpr std::int64_t runs(std::int64_t pixels) { return (pixels + run - 1) / run; }

    const PixelSum* sums;
    PathNoise* noise;
    std::int64_t pixels;
    double n;  ///< paths a pixel

    CHIARO_INLINE void operator()(std::int64_t i) const {
        PathNoise found;
        for (std::int64_t pixel = i * run; pixel < (i + 1) * run && pixel < pixels; ++pixel) {
            const PixelSum& sum = sums[pixel];
            const double square = (sum.r * sum.r + sum.g * sum.g + sum.b * sum.b) / (3 * n * n);
            const double variance = sum.squares / n - square;
            found.light += square;
            if (n > 1 && variance > 0) found.errors += variance / (n - 1);
        }
        noise[i] = found;
    }
};

}  // namespace chiaro::kernel

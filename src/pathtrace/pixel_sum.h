// What a pixel's paths have brought.
#pragma once
#include "kernel/rgba.h"

namespace chiaro {

struct PixelSum {
    double r = 0, g = 0, b = 0, a = 0;
    double squares = 0;  ///< (r² + g² + b²) / 3

    CHIARO_INLINE void add(const kernel::Rgba& path) {
        const double red = path.r, green = path.g, blue = path.b;
        r += red, g += green, b += blue, a += path.a;
        squares += (red * red + green * green + blue * blue) / 3;
    }
};

}  // namespace chiaro

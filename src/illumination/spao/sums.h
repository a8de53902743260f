// Sums of opacities from the grid's first corner on, which give the mean over any box exactly.
#pragma once
#include "illumination/spao/levels.h"
#include "illumination/spao/stored.h"

namespace chiaro::kernel {

/// Σ 65535 α over [0, x) × [0, y) × [0, z), x fastest; one number more along each axis than there are cells.
struct OpacitySums {
    const std::int64_t* sums;
    std::int32_t count[3];  ///< cells

    /// Mean of 65535 α over the cube of the given width about p (cells); outside counts as 0.
    CHIARO_INLINE double mean(double width, double x, double y, double z) const {
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const auto side = [&](int bit, double c)
                                  CHIARO_INLINE_LAMBDA { return c + 0.5 + (corner & bit ? 0.5 : -0.5) * width; };
            const int low_sides = !(corner & 1) + !(corner & 2) + !(corner & 4);
            sum += (low_sides % 2 ? -1 : 1) * below(side(1, x), side(2, y), side(4, z));
        }
        return sum / (width * width * width);
    }
    /// As AccessKernel asks for means.
    template <class F>
    CHIARO_INLINE F mean(std::int32_t level, Vec3<F> p) const {
        return F(mean(double(std::int64_t(1) << level), p.x, p.y, p.z));
    }

private:
    struct Place {
        std::int64_t first;
        double beyond;
    };
    static CHIARO_INLINE Place place(double v, std::int32_t n) {
        v = v < 0 ? 0 : v > n ? n : v;
        const std::int32_t first = min(std::int32_t(v), n - 1);
        return {first, v - first};
    }
    CHIARO_INLINE double below(double x, double y, double z) const {
        const Place i = place(x, count[0]), j = place(y, count[1]), k = place(z, count[2]);
        const std::int64_t row = count[0] + 1, slice = row * (count[1] + 1);
        const std::int64_t* s = sums + k.first * slice + j.first * row + i.first;
        const auto between = [](double a, double b, double t) CHIARO_INLINE_LAMBDA { return a + t * (b - a); };
        const auto along = [&](const std::int64_t* p)
                               CHIARO_INLINE_LAMBDA { return double(p[0]) + i.beyond * double(p[1] - p[0]); };
        const auto plane = [&](const std::int64_t* p)
                               CHIARO_INLINE_LAMBDA { return between(along(p), along(p + row), j.beyond); };
        return between(plane(s), plane(s + slice), k.beyond);
    }
};
using ExactKernel = AccessKernel<OpacitySums>;

/// Sums along x of row (y, z) of the cells to their place, whose layers before the first cells are 0.
CHIARO_INLINE void sum_cells(const OpacityGrid& opacity, int y, int z, std::int64_t* sums) {
    const std::int64_t row = opacity.count[0] + 1, slice = row * (opacity.count[1] + 1);
    const std::uint16_t* from = opacity.row(y, z);
    std::int64_t* to = sums + (z + 1) * slice + (y + 1) * row + 1;
    std::int64_t sum = 0;
    for (int x = 0; x < opacity.count[0]; ++x) to[x] = sum += from[x];
}
/// Adds to each of `count` lines of numbers, `stride` apart, the one before; `width` next to each other.
CHIARO_INLINE void add_up(std::int64_t* first, int count, std::int64_t stride, int width) {
    for (int i = 1; i < count; ++i)
        for (int x = 0; x < width; ++x) first[i * stride + x] += first[(i - 1) * stride + x];
}

}  // namespace chiaro::kernel

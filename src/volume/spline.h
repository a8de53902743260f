// Cubic B-splines over voxels in bricks (Sigg and Hadwiger 2005; Ruijters et al. 2008): 4³ coefficients a sample.
#pragma once
#include "kernel/gather.h"
#include "kernel/vec.h"
#include "volume/bricks.h"

namespace chiaro::kernel {

/// Weights of four coefficients, at a share of the way from the second to the third, as three lerps: so equal
/// coefficients give that very number, and no value lies beyond its coefficients but for rounding.
template <class F>
struct SplineWeights {
    F first, second, both;  ///< within either pair, and between the pairs

    explicit CHIARO_INLINE SplineWeights(F t) {
        const F u = F(1) - t, t2 = t * t, u2 = u * u;
        const F w0 = u2 * u, w1 = mad(F(3) * t - F(6), t2, F(4)), w2 = mad(F(3) * u - F(6), u2, F(4)), w3 = t2 * t;
        first = w1 / (w0 + w1);
        second = w3 / (w2 + w3);
        both = F(1.0f / 6) * (w2 + w3);
    }
    CHIARO_INLINE F of(F a, F b, F c, F d) const { return lerp(lerp(a, b, first), lerp(c, d, second), both); }
    CHIARO_INLINE F of(const Four<F>& v) const { return of(v.a, v.b, v.c, v.d); }
};

/// Four rows of four coefficients, of one slice of the 4³ around a point.
template <class F, class Voxel>
CHIARO_INLINE Four<Four<F>> spline_rows(const Voxel* coefficients, const typename GatherIndex<F>::type& index,
                                        int slice) {
    return gather_four(coefficients + slice * brick_slice - 1, index, {-brick_row, 0, brick_row, 2 * brick_row});
}

// Apart, so that what is not splined keeps its registers; static, because units of all instruction sets have their own.
template <class F, class Voxel>
static CHIARO_NOINLINE F spline_value(const Voxel* coefficients, const typename GatherIndex<F>::type& index,
                                      const Vec3<F>& t) {
    const SplineWeights<F> x(t.x), y(t.y), z(t.z);
    const auto slice = [&](int k) CHIARO_INLINE_LAMBDA {
        const Four<Four<F>> rows = spline_rows<F>(coefficients, index, k);
        return y.of(x.of(rows.a), x.of(rows.b), x.of(rows.c), x.of(rows.d));
    };
    const F low = lerp(slice(-1), slice(0), z.first), high = lerp(slice(1), slice(2), z.second);
    return lerp(low, high, z.both);
}

/// The least and the largest of the 4³.
template <class F, class Voxel>
static CHIARO_NOINLINE Two<F> spline_range(const Voxel* coefficients, const typename GatherIndex<F>::type& index) {
    Two<F> range{F(3e38f), F(-3e38f)};
    const auto add = [&](const Four<F>& row) CHIARO_INLINE_LAMBDA {
        range.a = min(min(range.a, min(row.a, row.b)), min(row.c, row.d));
        range.b = max(max(range.b, max(row.a, row.b)), max(row.c, row.d));
    };
    for (int slice = -1; slice < 3; ++slice) {
        const Four<Four<F>> rows = spline_rows<F>(coefficients, index, slice);
        add(rows.a), add(rows.b), add(rows.c), add(rows.d);
    }
    return range;
}

/// Of the largest number met: six lerps in a row, each within 1.5 × 2^-24.
inline constexpr float spline_rounding = 2e-6f;

/// Which of the volume's arrays hold coefficients, and what they stand for.
template <class Voxel>
struct SplineView {
    const Voxel* coefficients;  ///< null: values are linear between voxels
    float base, scale, least;   ///< stored = (coefficient - base) * scale + least
    Float3 reach;               ///< voxels: how far the points lie of which a normal is the mean (normal_reach); or 0

    template <class F>
    CHIARO_INLINE F stored(F coefficient) const {
        return mad(coefficient - F(base), F(scale), F(least));
    }
    /// Of the values that coefficients of such a range make, rounding included.
    template <class F>
    CHIARO_INLINE Two<F> stored(Two<F> range) const {
        const F largest = max(max(abs(range.a), abs(range.b)), F(base));
        const F reach = select(range.a == range.b, F(0), F(spline_rounding * scale) * largest);
        return {stored(range.a) - reach, stored(range.b) + reach};
    }
};

}  // namespace chiaro::kernel

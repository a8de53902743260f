// Powers in single precision, the same steps in scalar and SIMD code.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// log2(x) for finite x > 0, relative error below 1e-6 away from 1: mantissa m in [√½, √2), log m = 2
/// artanh((m-1)/(m+1)) by its series.
template <class F>
CHIARO_INLINE F log2(F x) {
    const Int<F> bits = bits_of(x);
    const Int<F> exponent = (bits - Int<F>(0x3f3504f3)) >> Int<F>(23);
    const F m = float_of(bits - (exponent << Int<F>(23)));
    const F s = (m - F(1)) / (m + F(1)), q = s * s;
    F series = mad(q, F(1.0f / 9), F(1.0f / 7));
    series = mad(q, series, F(1.0f / 5));
    series = mad(q, series, F(1.0f / 3));
    series = mad(q, series, F(1));
    return mad(s * series, F(2.885390082f), to_float(exponent));  // 2 / ln 2
}

/// 2^x, relative error below 1e-6; 0 below -126.
template <class F>
CHIARO_INLINE F exp2(F x) {
    const F clamped = max(min(x, F(127)), F(-126));
    const F whole = floor(clamped + F(0.5f));
    const F r = (clamped - whole) * F(0.6931471806f);  // 2^f = e^(f ln 2), |r| <= .35
    F series = mad(r, F(1.0f / 5040), F(1.0f / 720));
    series = mad(r, series, F(1.0f / 120));
    series = mad(r, series, F(1.0f / 24));
    series = mad(r, series, F(1.0f / 6));
    series = mad(r, series, F(0.5f));
    series = mad(r, series, F(1));
    series = mad(r, series, F(1));
    const F power = float_of(bits_of(series) + (truncate(whole) << Int<F>(23)));
    return select(x < F(-126), F(0), power);
}

/// 2^x for x <= 0, relative error below 4e-6 (the best of degree 4 on [-½, ½]); 0 below -126. A third fewer
/// instructions than exp2.
template <class F>
CHIARO_INLINE F exp2_below_0(F x) {
    const auto series_of = [](F r) CHIARO_INLINE_LAMBDA {
        F series = mad(r, F(0.009782912f), F(0.055976883f));
        series = mad(r, series, F(0.24020711f));
        series = mad(r, series, F(0.69311360f));
        return mad(r, series, F(1));
    };
    if (!any(x < F(-0.5f))) return series_of(x);
    const F clamped = max(x, F(-126));
    const F whole = floor(clamped + F(0.5f)), series = series_of(clamped - whole);
    const F power = float_of(bits_of(series) + (truncate(whole) << Int<F>(23)));
    return zero_below(x, F(-126), power);
}

/// base^exponent for base >= 0; 0^0 is 1.
template <class F>
CHIARO_INLINE F pow(F base, F exponent) {
    const F power = exp2(exponent * log2(max(base, F(1e-30f))));
    return select((base < F(1e-30f)) & (exponent > F(0)), F(0), power);
}

template <class F>
struct SinCos {
    F sin, cos;
};

/// Of an angle in turns, [0, 1]: Taylor's series about the nearest quarter, within 3e-7.
template <class F>
CHIARO_INLINE SinCos<F> sin_cos(F turns) {
    const Int<F> quarter = truncate(mad(turns, F(4), F(0.5f)));
    const F r = (turns - F(0.25f) * to_float(quarter)) * F(6.283185307f), q = r * r;
    const F s = r * mad(q, mad(q, mad(q, F(-1.0f / 5040), F(1.0f / 120)), F(-1.0f / 6)), F(1));
    const F c = mad(q, mad(q, mad(q, mad(q, F(1.0f / 40320), F(-1.0f / 720)), F(1.0f / 24)), F(-0.5f)), F(1));
    const Mask<F> odd = (quarter & Int<F>(1)) == Int<F>(1);
    const F sine = select(odd, c, s), cosine = select(odd, s, c);
    const Mask<F> below = (quarter & Int<F>(2)) == Int<F>(2), left = ((quarter + Int<F>(1)) & Int<F>(2)) == Int<F>(2);
    return {select(below, F(0) - sine, sine), select(left, F(0) - cosine, cosine)};
}

}  // namespace chiaro::kernel

// Directions and how they are drawn: turned about an axis, by Henyey and Greenstein, by Lambert.
#pragma once
#include "kernel/math.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

inline constexpr float inverse_pi = 0.3183098862f;

/// atan2 in turns, [-½, ½], within 1e-7: the polynomial 4.4.49 of Abramowitz and Stegun.
template <class F>
CHIARO_INLINE F angle_in_turns(F y, F x) {
    const F across = abs(y), along = abs(x);
    const F t = min(across, along) / max(max(across, along), F(1e-30f)), q = t * t;
    F series = mad(q, F(0.0028662257f), F(-0.0161657367f));
    series = mad(q, series, F(0.0429096138f));
    series = mad(q, series, F(-0.0752896400f));
    series = mad(q, series, F(0.1065626393f));
    series = mad(q, series, F(-0.1420889944f));
    series = mad(q, series, F(0.1999355085f));
    series = mad(q, series, F(-0.3333314528f));
    F angle = t * mad(q, series, F(1)) * F(0.5f * inverse_pi);
    angle = select(across > along, F(0.25f) - angle, angle);
    angle = select(x < F(0), F(0.5f) - angle, angle);
    return select(y < F(0), F(0) - angle, angle);
}

/// The unit direction at cosine `z` to the axis and an azimuth in turns around it; the frame is that of Duff et al.,
/// Building an Orthonormal Basis, Revisited (JCGT 2017).
template <class F>
CHIARO_INLINE Vec3<F> around(Vec3<F> axis, F z, F turns) {
    const SinCos<F> azimuth = sin_cos(turns);
    const F r = sqrt(max(F(1) - z * z, F(0)));
    const F sign = select(axis.z < F(0), F(-1), F(1)), a = F(-1) / (sign + axis.z), b = axis.x * axis.y * a;
    const Vec3<F> u{mad(sign * axis.x * axis.x, a, F(1)), sign * b, F(0) - sign * axis.x},
        v{b, mad(axis.y * axis.y, a, sign), F(0) - axis.y};
    return mad(r * azimuth.cos, u, mad(r * azimuth.sin, v, z * axis));
}

/// P(g, cos θ) = (1 - g²) / (4π (1 + g² - 2 g cos θ)^1.5), θ between the directions before and behind (Henyey and
/// Greenstein 1941); it is also the density with which directions are drawn.
struct PhaseView {
    float g;

    template <class F>
    CHIARO_INLINE F density(F cosine) const {
        if (g == 0) return F(0.25f * inverse_pi);
        const F square = max(mad(F(-2 * g), cosine, F(1 + g * g)), F(1e-12f));
        return F((1 - g * g) * 0.25f * inverse_pi) / (square * sqrt(square));
    }

    /// The cosine below which a share u of the density lies, counted from behind.
    template <class F>
    CHIARO_INLINE F cosine(F u) const {
        if (g == 0) return mad(F(2), u, F(-1));
        const F ratio = F(1 - g * g) / mad(F(2 * g), u, F(1 - g));
        const F cosine = (F(1 + g * g) - ratio * ratio) * F(0.5f / g);
        return min(max(cosine, F(-1)), F(1));
    }
};

}  // namespace chiaro::kernel

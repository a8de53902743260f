// What a surface reflects: Lambert's law and one highlight (docs/theory/light.md).
#pragma once
#include "illumination/probe/reflection_table.h"
#include "kernel/gather.h"
#include "pathtrace/directions.h"
#include "pathtrace/path.h"

namespace chiaro::kernel {

/// f = c/π (1 - ρ(n·v)) (1 - ρ(n·l)) / (1 - ρ̄) + k/π (n·h)^s: Blinn's highlight (1977) over matter that is matte for
/// what the highlight leaves (Kelemen and Szirmay-Kalos 2001). ρ(μ) is what the highlight alone reflects of light from
/// all around, seen at the cosine μ; ρ̄ = 2 ∫ ρ μ dμ.
struct ReflectionView {
    static constexpr std::int32_t steps = ReflectionTable::steps;
    float strength, shininess;  ///< k, s; k = 0: matte
    const float* reflected;     ///< ρ at μ = 0, 1/steps ... 1
    float matte;                ///< 1 / (1 - ρ̄)

    /// ρ(n·v): the share of a path's next directions that are drawn from the highlight.
    template <class F>
    CHIARO_INLINE F highlight(Vec3<F> normal, Vec3<F> heading) const {
        return strength == 0 ? F(0) : reflected_at(F(0) - dot(normal, heading));
    }

    /// f (n·l), and the density of both ways of drawing together.
    template <class F>
    CHIARO_INLINE Scattered<F> scattered(const Path<F>& path, Vec3<F> direction) const {
        const F cosine = max(dot(path.normal, direction), F(0)), even = cosine * F(inverse_pi);
        const Mask<F> shines = path.shining > F(0);  // a path that begins at a point has met nothing yet
        if (!any(shines)) return {even, F(0), even};
        const F rest = F(1) - path.shining;
        const Vec3<F> sum = direction - path.heading;
        const Vec3<F> h = F(1) / sqrt(max(dot(sum, sum), F(1e-24f))) * sum;
        const F nh = max(dot(path.normal, h), F(0)), hv = max(F(0) - dot(h, path.heading), F(1e-6f));
        const F lobe = pow(nh, F(shininess));
        const F drawn = F((shininess + 2) * 0.125f * inverse_pi) * lobe * nh / hv;
        return {select(shines, even * (rest * (F(1) - reflected_at(cosine)) * F(matte)), even),
                select(shines, F(strength * inverse_pi) * lobe * cosine, F(0)),
                select(shines, mad(rest, even, path.shining * drawn), even)};
    }

    /// Matte: by the cosine; the highlight: about a half vector drawn by (n·h)^(s + 1).
    template <class F>
    CHIARO_INLINE Vec3<F> direction(const Path<F>& path, const Draw<F>& numbers) const {
        const F u = numbers.a, v = numbers.b;
        if (strength == 0) return around(path.normal, sqrt(u), v);
        const Mask<F> shines = numbers.c < path.shining;
        const F cosine = select(shines, pow(u, F(1 / (shininess + 2))), sqrt(u));
        const Vec3<F> drawn = around(path.normal, cosine, v);
        const Vec3<F> mirrored = path.heading - F(2) * dot(path.heading, drawn) * drawn;
        return select(shines, mirrored, drawn);
    }

private:
    template <class F>
    CHIARO_INLINE F reflected_at(F cosine) const {
        const F place = min(max(cosine, F(0)), F(1)) * F(float(steps));
        const Int<F> i = min(truncate(place), Int<F>(steps - 1));
        return lerp(gather_float(reflected, i), gather_float(reflected + 1, i), place - to_float(i));
    }
};

}  // namespace chiaro::kernel

namespace chiaro {

/// Valid as long as the table is.
inline kernel::ReflectionView view_of(const ReflectionTable& table) {
    return {float(table.strength()), float(table.shininess()), table.reflected().data(), float(table.matte())};
}

}  // namespace chiaro

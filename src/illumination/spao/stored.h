// The same products from means that can be asked for anywhere: stored levels, or exact sums. Look-ups may be moved off
// the cell, along the normal.
#pragma once
#include "illumination/cells/outward.h"
#include "illumination/spao/product.h"
#include "kernel/gather.h"
#include "kernel/launch.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Mean opacity of cubes of width 2^l, times 65535. Each level ends in a layer of zeros on every side: beyond it, 0.
struct StoredLevels {
    static constexpr int most = 16;
    struct Level {
        const std::uint16_t* cells;
        std::int32_t nx, ny, nz;
        float scale, shift;  ///< index = cell × scale + shift, on every axis
    };
    Level at[most];

    template <class F>
    CHIARO_INLINE F mean(std::int32_t l, Vec3<F> p) const {
        const Level& level = at[l];
        const auto place = [&](F c, std::int32_t n) CHIARO_INLINE_LAMBDA {
            return min(max(mad(c, F(level.scale), F(level.shift)), F(0)), F(float(n - 1)));
        };
        const Vec3<F> q{place(p.x, level.nx), place(p.y, level.ny), place(p.z, level.nz)};
        using I = Int<F>;
        const I x = min(truncate(q.x), I(level.nx - 2)), y = min(truncate(q.y), I(level.ny - 2)),
                z = min(truncate(q.z), I(level.nz - 2));
        const Vec3<F> t{q.x - to_float(x), q.y - to_float(y), q.z - to_float(z)};
        const std::int32_t row = level.nx, slice = level.nx * level.ny;
        const auto v = gather_two(level.cells, typename GatherIndex<F>::type(z * I(slice) + y * I(row) + x),
                                  {0, row, slice, slice + row});
        return lerp(lerp(lerp(v.a.a, v.a.b, t.x), lerp(v.b.a, v.b.b, t.x), t.y),
                    lerp(lerp(v.c.a, v.c.b, t.x), lerp(v.d.a, v.d.b, t.x), t.y), t.z);
    }
};

/// The accessibility of one cell, or sixteen. `Means` has mean(level, position).
template <class Means>
struct AccessKernel {
    Means means;
    std::int32_t shells;
    SpaoProduct product;
    float normal_factor;

    template <class F>
    CHIARO_INLINE F operator()(Vec3<F> p) const {
        const Vec3<F> n = normal_factor > 0 ? step_down_at(p) : Vec3<F>(F(0), F(0), F(0));
        if (product == SpaoProduct::corrected) return octants(p, n);
        if (product == SpaoProduct::thick) return cubes<SpaoProduct::thick>(p, shorten(n));
        return cubes<SpaoProduct::paper>(p, shorten(n));
    }

private:
    template <class F>
    CHIARO_INLINE Vec3<F> step_down_at(Vec3<F> p) const {
        const auto difference = [&](Vec3<F> d) CHIARO_INLINE_LAMBDA {
            return (means.mean(0, p - d) - means.mean(0, p + d)) * F(1.0f / 65535);
        };
        return {difference({F(1), F(0), F(0)}), difference({F(0), F(1), F(0)}), difference({F(0), F(0), F(1)})};
    }
    template <class F>
    static CHIARO_INLINE Vec3<F> shorten(Vec3<F> n) {
        return (F(1) / max(sqrt(dot(n, n)), F(1))) * n;
    }

    /// Cube l is centred at p + f n 2^l / 2.
    template <SpaoProduct p_, class F>
    CHIARO_INLINE F cubes(Vec3<F> p, Vec3<F> n) const {
        F r(1), outer = means.mean(shells, mad(F(0.5f * normal_factor * float(1 << shells)), n, p));
        for (std::int32_t l = shells - 1; l >= 0; --l) {
            const F inner = means.mean(l, mad(F(0.5f * normal_factor * float(1 << l)), n, p));
            r = join<p_>(r, open_share(inner, outer));
            outer = inner;
        }
        return finish<p_>(r);
    }

    template <class F>
    CHIARO_INLINE F octants(Vec3<F> p, Vec3<F> n) const {
        const F q = outward_share(n, normal_factor), self = means.mean(0, p);
        F all(0), outwards(0);
        for (int s = 0; s < 8; ++s) {
            const Float3 side{s & 1 ? 1.0f : -1.0f, s & 2 ? 1.0f : -1.0f, s & 4 ? 1.0f : -1.0f};
            const F r = octant(p, Vec3<F>(side), self);
            all = all + r;
            outwards = outwards + max(dot(Vec3<F>(side), n), F(0)) * r;
        }
        return weigh_octants(q, n, all, outwards);
    }

    /// Π_l (1 - S_l,s)^(t_l), O_l,s = A_(l-1)(p + s 2^(l-2)), O_0 = α.
    template <class F>
    CHIARO_INLINE F octant(Vec3<F> p, Vec3<F> side, F self) const {
        const auto mean = [&](std::int32_t l) CHIARO_INLINE_LAMBDA {
            return l == 0 ? self : means.mean(l - 1, mad(F(0.25f * float(1 << l)), side, p));
        };
        F r(1), outer = mean(shells);
        for (std::int32_t l = shells - 1; l >= 0; --l) {
            const F inner = mean(l);
            r = join<SpaoProduct::corrected>(r, open_share(inner, outer));
            outer = inner;
        }
        return finish<SpaoProduct::corrected>(r);
    }
};
using StoredKernel = AccessKernel<StoredLevels>;

/// Some cells of a row.
struct SpaoCells {
    std::int32_t x, count, y, z;
    std::uint16_t* out;  ///< of cell x
};

template <class F, class Kernel>
CHIARO_INLINE void access_row(const Kernel& kernel, const SpaoCells& cells) {
    constexpr std::int32_t lanes = LaneTraits<F>::count;
    for (std::int32_t i = 0; i < cells.count; i += lanes) {
        const Int<F> x = Int<F>(cells.x + i) + BlockShape<F>::column() + BlockShape<F>::row() * Int<F>(4);
        const Vec3<F> p{to_float(x), F(float(cells.y)), F(float(cells.z))};
        std::uint16_t values[lanes];
        store_shares(min(kernel(p), F(1)), values);
        for (std::int32_t k = 0; k < lanes && i + k < cells.count; ++k) cells.out[i + k] = values[k];
    }
}

}  // namespace chiaro::kernel

// The classified volume as paths meet it: a cloud in which they collide by chance.
#pragma once
#include "pathtrace/directions.h"
#include "pathtrace/path.h"
#include "pathtrace/regions.h"

namespace chiaro::kernel {

/// The colours of what scatters; entry by entry, or, of mixtures, in the entry itself: 10 bits each.
struct ColoursView {
    const float *red, *green, *blue;  ///< null: of mixtures
    template <class F>
    CHIARO_INLINE Vec3<F> at(Int<F> entry) const {
        if (!red) {
            const auto part = [&](int shift) CHIARO_INLINE_LAMBDA {
                return F(1.0f / 1023) * to_float((entry >> Int<F>(shift)) & Int<F>(1023));
            };
            return {part(20), part(10), part(0)};
        }
        return {gather_float(red, entry), gather_float(green, entry), gather_float(blue, entry)};
    }
};

/// What paths collide with in a mixture.
struct MixtureCollisions {
    float max_extinction;  ///< per mm
    float most;            ///< of an albedo's largest channel

    /// The entry of a colour. Rounded up as often as u in [0, 1) says, so that the mean stays.
    template <class F>
    CHIARO_INLINE Int<F> entry_of(const RgbaLanes<F>& matter, F kappa, F u) const {
        Vec3<F> c = (F(1) / max(kappa, F(1e-30f))) * colour_of(matter);
        c = min(F(most) / max(max(max(c.x, c.y), c.z), F(1e-30f)), F(1)) * c;
        const auto part = [&](F x, int shift) CHIARO_INLINE_LAMBDA {
            return truncate(mad(min(max(x, F(0)), F(1)), F(1023), u)) << Int<F>(shift);
        };
        return part(c.x, 20) + part(c.y, 10) + part(c.z, 0);
    }
};

/// Delta tracking (Woodcock et al. 1965) with majorants by region (Szirmay-Kalos et al. 2011): in a medium filled up to
/// the region's majorant, tentative collisions lie exponentially far apart; one is real with the probability κ / μ.
/// Towards the light nothing is drawn: every tentative collision leaves 1 - κ / μ of it (ratio tracking, Novák et al.
/// 2014).
template <class Voxel>
struct Cloud {
    VolumeView<Voxel> volume;
    RegionsView regions;
    const float* extinction;  ///< per mm, over the optical table
    ColoursView colours;
    float scale, offset, last;  ///< entry = stored * scale + offset
    PhaseView phase;
    MixtureCollisions mixed{};

    static constexpr bool has_normals = false, has_cuts = false;
    static constexpr int light_candidates = 1;  ///< an even phase function makes no choice

    /// A new way has been taken.
    template <class F>
    CHIARO_INLINE void begin(Mask<F> lanes, const Cut<F>&, Path<F>& path) const {
        const Draw<F> numbers = draw_for(lanes, path);
        path.depth = select(lanes, free_depth(numbers.a), path.depth);
        path.leave = select(lanes, F(0), path.leave);
    }

    template <class F>
    CHIARO_INLINE void travel(Path<F>& path) const {
        travel(at_stage(path, travelling), path);
    }
    /// To the next tentative collision, or through the region.
    template <class F>
    CHIARO_INLINE void travel(Mask<F> going, Path<F>& path) const {
        const Mask<F> lost = going & (path.t >= path.leave);
        if (any(lost)) regions.enter(volume, lost, path);
        const F through = (path.leave - path.t) * path.majorant;
        const Mask<F> meets = going & (through > path.depth), passes = going & !meets;
        const F free_way = path.depth / max(path.majorant, F(1e-30f));
        path.t = select(meets, path.t + free_way, select(passes, path.leave, path.t));
        path.depth = select(passes, path.depth - through, path.depth);
        path.stage = select(meets, Int<F>(met), path.stage);
        path.stage = select(passes & (path.t >= path.end), Int<F>(escaped), path.stage);
    }

    /// A real collision, or none; on the way to the light always none, but less light.
    template <class F>
    CHIARO_INLINE void meet(Mask<F> lanes, Path<F>& path) const {
        using I = Int<F>;
        const Vec3<F> p = volume.clamp(mad(path.t, path.direction, path.origin));
        const auto where = volume.locate(p, volume.voxel(p));
        const Draw<F> numbers = draw_for(lanes, path);
        I entry;
        F kappa;
        if (volume.is_mixed()) {
            const RgbaLanes<F> matter = volume.matter_at(where);
            kappa = min(alpha_of(matter), F(mixed.max_extinction));
            entry = mixed.entry_of<F>(matter, alpha_of(matter), numbers.c);
        } else {
            const F value = volume.value(where);
            entry = entry_of(value);
            kappa = gather_float(extinction, entry);
            if (volume.has_factor()) kappa = kappa * volume.factor_at(where, value);
        }
        path.depth = select(lanes, free_depth(numbers.b), path.depth);
        const Mask<F> shadow = lanes & (path.to_light == I(1));
        const Mask<F> real = lanes & (path.to_light == I(0)) & (numbers.a * path.majorant < kappa);
        path.material = select(real, entry, path.material);
        path.stage = select(lanes, select(real, I(collided), I(travelling)), path.stage);
        if (any(shadow)) dim(shadow, kappa, numbers.c, path);
    }

    template <class F>
    CHIARO_INLINE Scattered<F> scattered(const Path<F>& path, Vec3<F> direction) const {
        const F density = phase.density(dot(path.heading, direction));
        return {density, F(0), density};
    }
    template <class F>
    CHIARO_INLINE Vec3<F> direction(const Path<F>& path, const Draw<F>& numbers) const {
        return around(path.heading, phase.cosine(numbers.a), numbers.b);
    }

    template <class F>
    CHIARO_INLINE Int<F> entry_of(F stored) const {
        return truncate(min(max(mad(stored, F(scale), F(offset)), F(0)), F(last)));
    }

private:
    /// Below a tenth the way goes on with that probability only (Russian roulette).
    template <class F>
    CHIARO_INLINE void dim(Mask<F> shadow, F kappa, F u, Path<F>& path) const {
        constexpr float faint = 0.1f;
        F left = path.transmittance * max(F(1) - kappa / max(path.majorant, F(1e-30f)), F(0));
        left = select(left < F(faint), select(u * F(faint) < left, F(faint), F(0)), left);
        path.transmittance = select(shadow, left, path.transmittance);
        path.stage = select(shadow & !(left > F(0)), Int<F>(escaped), path.stage);
    }
};

}  // namespace chiaro::kernel

// The classified volume with its surfaces as paths meet it (docs/theory/light.md): matter whose opacity rises steeply
// scatters as a surface.
#pragma once
#include "classify/surface_view.h"
#include "pathtrace/cloud.h"
#include "pathtrace/reflection.h"

namespace chiaro::kernel {

/// A Cloud, but for what happens at a collision: with the probability q of the place light is reflected by a surface,
/// and leaves the skin it has met without being dimmed by it. Where dimming begins is
/// the first event of a Poisson process of rate -ln(h) in half a voxel, or where opacity rises again.
template <class Voxel>
struct SurfaceCloud : Cloud<Voxel> {
    using Base = Cloud<Voxel>;
    SurfaceView surface;
    ReflectionView reflection;

    static constexpr bool has_cuts = true;
    static constexpr int light_candidates = 4;  ///< of 2, 3, 4, 6 the least time to an error on sample:tubes

    template <class F>
    CHIARO_INLINE void begin(Mask<F> lanes, const Cut<F>& cut, Path<F>& path) const {
        Base::begin(lanes, cut, path);
        path.held = select(lanes, F(0), path.held);
        const Mask<F> leaving = lanes & (path.on_surface > F(0)) & (path.on_surface < F(on_floor));
        if (any(leaving)) path.held = select(leaving, free_depth(draw_for(leaving, path).a), path.held);
        const Mask<F> cut_open = lanes & cut.open & at_stage(path, travelling);
        if (any(cut_open)) enter_cut(cut_open, cut, path);
    }

    template <class F>
    CHIARO_INLINE void travel(Path<F>& path) const {
        const Mask<F> going = at_stage(path, travelling), leaving = going & (path.held > F(0));
        const Mask<F> free = going & !leaving;
        if (any(free)) Base::travel(free, path);
        const bool enough = kernel::count(leaving) >= LaneTraits<F>::count / 4 || !any(free);
        if (enough && any(leaving)) leave_skin(leaving, path);
    }

    template <class F>
    CHIARO_INLINE void meet(Mask<F> lanes, Path<F>& path) const {
        Base::meet(lanes, path);
        const Mask<F> real = lanes & at_stage(path, collided);
        if (!any(real)) return;
        const Skin<F> skin = nearest_skin(real, path);
        const Draw<F> numbers = draw_for(real, path);
        const Mask<F> reflecting = reflect(real & (numbers.a < skin.share), real, skin.outward, path);
        path.t = select(reflecting, skin.t, path.t);
    }

    template <class F>
    CHIARO_INLINE Scattered<F> scattered(const Path<F>& path, Vec3<F> direction) const {
        const Mask<F> surfaces = path.on_surface > F(0);
        const Scattered<F> there = reflection.scattered(path, direction), else_where = Base::scattered(path, direction);
        return {select(surfaces, there.coloured, else_where.coloured), there.shine,
                select(surfaces, there.density, else_where.density)};
    }
    template <class F>
    CHIARO_INLINE Vec3<F> direction(const Path<F>& path, const Draw<F>& numbers) const {
        return select(path.on_surface > F(0), reflection.direction(path, numbers), Base::direction(path, numbers));
    }

private:
    template <class F>
    struct Skin {
        F t, share;
        Vec3<F> outward;
    };

    /// The surface of a collision. A way that has just passed a skin and collides up to two voxels behind it, in matter
    /// that is even there, has met that skin.
    template <class F>
    CHIARO_INLINE Skin<F> nearest_skin(Mask<F> real, const Path<F>& path) const {
        const auto skin_at = [&](F t) CHIARO_INLINE_LAMBDA {
            const SurfaceAt<F> s = surface.at(this->volume, this->volume.clamp(mad(t, path.direction, path.origin)));
            return Skin<F>{t, s.share, s.outward};
        };
        Skin<F> found = skin_at(path.t);
        for (int voxels = 1; voxels <= 2; ++voxels) {
            const F t = path.t - F(float(voxels) * surface.edge_mm);
            const Mask<F> unsure = real & (found.share < F(1)) & (t > F(0));
            if (!any(unsure)) break;
            const Skin<F> passed = skin_at(t);
            const Mask<F> better = unsure & (passed.share > found.share);
            found = {select(better, passed.t, found.t), select(better, passed.share, found.share),
                     select(better, passed.outward, found.outward)};
        }
        return found;
    }

    /// Half a voxel, or to where dimming begins.
    template <class F>
    CHIARO_INLINE void leave_skin(Mask<F> leaving, Path<F>& path) const {
        const F step(0.5f * surface.edge_mm);
        const Vec3<F> p = this->volume.clamp(mad(path.t, path.direction, path.origin));
        const SurfaceAt<F> s = surface.at(this->volume, p);
        const F rate = free_depth(max(s.hold, F(1e-6f)));  // in half a voxel
        const Mask<F> ends = leaving & ((path.held < rate) | surface.rises(this->volume, s, p, path.direction));
        const F way = step * select(ends, select(path.held < rate, path.held / max(rate, F(1e-30f)), F(0)), F(1));
        path.t = select(leaving, path.t + way, path.t);
        path.held = select(leaving, select(ends, F(0), max(path.held - rate, F(1e-30f))), path.held);
        path.stage = select(leaving & (path.t >= path.end), Int<F>(escaped), path.stage);
    }

    /// A cut through solid matter is a surface.
    template <class F>
    CHIARO_INLINE void enter_cut(Mask<F> lanes, const Cut<F>& cut, Path<F>& path) const {
        const Vec3<F> p = this->volume.clamp(path.origin);
        const auto where = this->volume.locate(p, this->volume.voxel(p));
        Int<F> entry;
        F opacity;
        if (this->volume.is_mixed()) {
            const RgbaLanes<F> matter = this->volume.matter_at(where);
            opacity = surface.opacity_of_edge(alpha_of(matter));
            entry = this->mixed.template entry_of<F>(matter, alpha_of(matter), F(0.5f));
        } else {
            const F value = this->volume.value(where);
            opacity = surface.opacity_of(value);
            if (this->volume.has_factor()) opacity = opacity_of_share(opacity, this->volume.factor_at(where, value));
            entry = this->entry_of(value);
        }
        lanes = lanes & (opacity >= F(0.5f));
        if (!any(lanes)) return;
        const Vec3<F> g = surface.to_world(cut.normal);
        const Mask<F> shadow = lanes & (path.to_light == Int<F>(1)), real = lanes & !shadow;
        path.transmittance = select(shadow, F(0), path.transmittance);
        path.stage = select(shadow, Int<F>(escaped), select(real, Int<F>(collided), path.stage));
        path.material = select(real, entry, path.material);
        reflect(real, real, F(1) / sqrt(max(dot(g, g), F(1e-24f))) * g, path);
    }

    /// Some of the lanes that collided met a surface; those that have a normal there are returned.
    template <class F>
    CHIARO_INLINE Mask<F> reflect(Mask<F> surfaces, Mask<F> collided_lanes, Vec3<F> outward, Path<F>& path) const {
        const Vec3<F> n = select(dot(outward, path.heading) > F(0), F(-1), F(1)) * outward;
        surfaces = surfaces & (dot(n, n) > F(0.5f));
        path.on_surface = select(collided_lanes, select(surfaces, F(1), F(0)), path.on_surface);
        path.shining =
            select(collided_lanes, select(surfaces, reflection.highlight(n, path.heading), F(0)), path.shining);
        path.normal = select(surfaces, n, path.normal);
        return surfaces;
    }
};

}  // namespace chiaro::kernel

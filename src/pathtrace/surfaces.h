// Isosurfaces as paths meet them, found as the ray caster finds them.
#pragma once
#include "illumination/view.h"
#include "pathtrace/cloud.h"
#include "pathtrace/reflection.h"

namespace chiaro::kernel {

/// Surfaces of one value each, in stored units, ascending. One of opacity o < 1 lets a share 1 - o of the paths
/// through.
template <class Voxel>
struct Surfaces {
    static constexpr int most = 8;
    static constexpr bool has_normals = true, has_cuts = false;
    static constexpr int light_candidates = 4;

    VolumeView<Voxel> volume;
    RegionsView regions;  ///< majorant 0 where no surface passes
    float values[most], opacities[most];
    std::int32_t count;
    ColoursView colours;
    ShadingView gradients;  ///< turns gradients to world normals
    ReflectionView reflection;
    float step_mm;
    LabelView labels;         ///< that cut and tint them; null: none
    float outside;            ///< SurfacesView::outside
    Rgba untinted[most];      ///< where labels tint: colours, of alpha 1
    MixtureCollisions mixed;  ///< what becomes of them

    template <class F>
    CHIARO_INLINE F value_at(Vec3<F> p) const {
        p = volume.clamp(p);
        const auto at = volume.locate(p, volume.voxel(p));
        return shown_value(labels, at, volume.value(at), outside);
    }

    /// Where a way enters a cut inside a surface, the surface lies in the plane.
    template <class F>
    CHIARO_INLINE void begin(Mask<F> lanes, const Cut<F>& cut, Path<F>& path) const {
        const Vec3<F> p = volume.clamp(path.origin);
        const F value = value_at(p);
        path.depth = select(lanes, value, path.depth);
        path.leave = select(lanes, F(0), path.leave);
        Mask<F> inside = lanes & cut.open & (path.stage == Int<F>(travelling));
        for (std::int32_t i = count - 1; i >= 0 && any(inside); --i) {
            const Draw<F> numbers = draw_for(inside, path);
            const Mask<F> hit = inside & (value >= F(values[i])) & (numbers.a < F(opacities[i]));
            if (any(hit)) collide(hit, material_of(Int<F>(i), p, numbers.c), cut.normal, path);
            inside = inside & !hit;
        }
    }

    /// To the end of a step in which a surface is crossed, or of one that meets none, or through what is empty.
    template <class F>
    CHIARO_INLINE void travel(Path<F>& path) const {
        const Mask<F> going = at_stage(path, travelling), lost = going & (path.t >= path.leave);
        if (any(lost)) regions.enter(volume, lost, path);
        const Mask<F> empty = going & !(path.majorant > F(0)), steps = going & !empty;
        path.t = select(empty, path.leave, path.t);  // behind it the value is still on the same sides
        Mask<F> crosses = steps & !steps;
        F far = path.t;
        if (any(steps)) {
            far = min(path.t + F(step_mm), path.end);
            const F value = value_at(mad(far, path.direction, path.origin));
            crosses = next_surface(steps, path, value);
            path.depth = select(steps & !crosses, value, path.depth);
            path.t = select(steps & !crosses, far, path.t);
        }
        path.stage = select(crosses, Int<F>(met), path.stage);
        path.stage = select(going & (!crosses) & (path.t >= path.end), Int<F>(escaped), path.stage);
    }

    /// The place of the crossing: bisected to 1/128 of a step, then linear.
    template <class F>
    CHIARO_INLINE void meet(Mask<F> lanes, Path<F>& path) const {
        const F surface = one_of<F>(values, path.surface);
        F near = path.t, far = min(path.t + F(step_mm), path.end);
        const auto at = [&](F t) CHIARO_INLINE_LAMBDA { return value_at(mad(t, path.direction, path.origin)); };
        const Mask<F> below = path.depth < surface;
        F value_near = at(near), value_far = at(far);
        for (int halving = 0; halving < 7; ++halving) {
            const F middle = F(0.5f) * (near + far), between = at(middle);
            const Mask<F> same = (below & (between < surface)) | ((!below) & (between >= surface));
            near = select(same, middle, near), far = select(same, far, middle);
            value_near = select(same, between, value_near), value_far = select(same, value_far, between);
        }
        const F rise = value_far - value_near;
        const F share =
            select(abs(rise) > F(0), (surface - value_near) / select(abs(rise) > F(0), rise, F(1)), F(0.5f));
        path.t = select(lanes, lerp(near, far, min(max(share, F(0)), F(1))), path.t);
        // What passes goes on from the other side.
        const F beyond = select(below, surface, surface - max(abs(surface) * F(2e-7f), F(1e-37f)));
        path.depth = select(lanes, beyond, path.depth);
        path.stage = select(lanes, Int<F>(travelling), path.stage);
        const Draw<F> numbers = draw_for(lanes, path);
        const Mask<F> hit = lanes & (numbers.a < one_of<F>(opacities, path.surface));
        if (!any(hit)) return;
        const Vec3<F> p = volume.clamp(mad(path.t, path.direction, path.origin));
        const auto where = volume.locate(p, volume.voxel(p));
        const Vec3<F> gradient =
            surface_gradient(labels, where, volume.value(where) - surface, volume.gradient(where), outside);
        collide(hit, material_of(path.surface, p, numbers.c), gradient, path);
    }

    template <class F>
    CHIARO_INLINE Scattered<F> scattered(const Path<F>& path, Vec3<F> direction) const {
        return reflection.scattered(path, direction);
    }
    template <class F>
    CHIARO_INLINE Vec3<F> direction(const Path<F>& path, const Draw<F>& numbers) const {
        return reflection.direction(path, numbers);
    }

private:
    template <class F>
    CHIARO_INLINE F one_of(const float (&numbers)[most], Int<F> surface) const {
        F number(numbers[0]);
        for (std::int32_t i = 1; i < count; ++i) number = select(surface == Int<F>(i), F(numbers[i]), number);
        return number;
    }

    /// The entry of a surface's colour; u in [0, 1).
    template <class F>
    CHIARO_INLINE Int<F> material_of(Int<F> surface, Vec3<F> p, F u) const {
        if (!labels.tint) return surface;
        const auto where = volume.locate(p, volume.voxel(p));
        return mixed.template entry_of<F>(tinted(labels, where, load_rgba(untinted, surface)), F(1), u);
    }

    /// Whether a surface lies between the value here and the next one, and which is the nearest: where values rise the
    /// lowest, else the highest.
    template <class F>
    CHIARO_INLINE Mask<F> next_surface(Mask<F> lanes, Path<F>& path, F value) const {
        Int<F> which(-1);
        for (std::int32_t i = count - 1; i >= 0; --i)
            which = select((path.depth < F(values[i])) & (value >= F(values[i])), Int<F>(i), which);
        for (std::int32_t i = 0; i < count; ++i)
            which = select((path.depth >= F(values[i])) & (value < F(values[i])), Int<F>(i), which);
        const Mask<F> crossed = lanes & (which >= Int<F>(0));
        path.surface = select(crossed, which, path.surface);
        return crossed;
    }

    /// The normal on the side the path comes from; on the way to the light there is none left.
    template <class F>
    CHIARO_INLINE void collide(Mask<F> hit, Int<F> material, Vec3<F> gradient, Path<F>& path) const {
        SamplePoint<F> sample{path.origin, F(0)};
        gradients.reflect(gradient, sample);
        Vec3<F> n = sample.outward;
        const Mask<F> flat = dot(n, n)<F(0.5f), away = dot(n, path.heading)> F(0);
        n = select(flat | away, F(-1) * select<F>(flat, path.heading, n), n);
        const Mask<F> shadow = hit & (path.to_light == Int<F>(1)), real = hit & !shadow;
        path.transmittance = select(shadow, F(0), path.transmittance);
        path.normal = select(real, n, path.normal);
        path.on_surface = select(real, F(1), path.on_surface);
        path.shining = select(real, reflection.highlight(n, path.heading), path.shining);
        path.material = select(real, material, path.material);
        path.stage = select(real, Int<F>(collided), select(shadow, Int<F>(escaped), path.stage));
    }
};

}  // namespace chiaro::kernel

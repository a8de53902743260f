// The one question that every illumination method answers inside the ray caster: how much light of what colour arrives
// at this sample? A method's view is a trivially copyable struct with
//
//     static constexpr bool modulates;   // false: the answer is the shading's own; the caster may leave the call out
//     static constexpr bool adds_opacity;  // true: has glows and glow(), see illumination/histogram/field.h
//     static constexpr bool by_surface;  // true: may ask where surfaces are: has asks_surfaces(), and incident() takes
//                                        // which lanes are seen, their step and the surface that their ray has met
//     static constexpr bool remembers_surfaces;  // of those: what lies behind a skin belongs to it
//     template <class F> Incident<F> incident(const SamplePoint<F>&, const ShadingView&) const;
//
// Colour of a sample = opacity × (albedo × diffuse + specular).
#pragma once
#include "kernel/math.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

/// A volume's cuts by number: the planes of its clip, then its borders, 2 axis, and 1 more at the far end.
inline constexpr std::int32_t clip_planes = 12, cuts = clip_planes + 6;

/// The surface that a sample belongs to.
template <class F>
struct SurfacePoint {
    F share{0};  ///< q: of the sample; 0 where the surface that was met will do
    Vec3<F> p_voxel{F(0), F(0), F(0)};
    Vec3<F> normal{F(0), F(0), F(0)};  ///< unit, world, towards the eye; 0 where there is no gradient
    F depth{0.5f};                     ///< smallest edges from there to the outside
};

template <class F>
struct SamplePoint {
    Vec3<F> p_voxel;
    F value;                            ///< stored units
    F lambert{0};                       ///< |n · l|, 0 where there is no gradient
    F highlight{0};                     ///< (n · h)^shininess
    F rise{0};                          ///< ∇f · l of unit vectors: > 0 where values rise towards the light
    Vec3<F> outward{F(0), F(0), F(0)};  ///< n, unit, world; 0 where there is no gradient
    F solid{0};                         ///< 0 up to an optical depth of 1/2 over a voxel's edge, 1 from 3/2 on
    SurfacePoint<F> surface{};          ///< of views that ask where surfaces are
    F cut{-1};                          ///< the cut through solid matter on which it lies; below 0: none
};

/// The surface that a ray has met: of the samples of the last two edges the one with the largest share. What lies
/// behind a skin, where values are even, belongs to it (docs/theory/light.md).
template <class F>
struct MetSurface {
    F share{0};
    F step{-1e6f};                    ///< where
    Vec3<F> e{F(0), F(0), F(0)};      ///< the light on it, less what its highlight reflects
    Vec3<F> shine{F(0), F(0), F(0)};  ///< of its highlight
};

template <class F>
struct Incident {
    Vec3<F> diffuse, specular;
};

/// A light beside the one that ShadingView itself has.
struct LightView {
    Float3 diffuse, specular;  ///< the reflection model's factors times its colour
    Float3 to_light, half;     ///< unit, world; of a point light to_light is its place from the first voxel, mm
    std::int32_t is_point;
};

/// The reflection model's factors, the light's colour multiplied in. Shading off: ambient 1, the others 0.
struct ShadingView {
    bool enabled;
    float ambient, shininess;
    float out;  ///< -1 where values grow inwards, as isosurfaces see it: the side that a gradient must be turned to
    Float3 diffuse, specular;
    Float3 to_light, half;                      ///< unit, world
    Float3 gradient_x, gradient_y, gradient_z;  ///< rows of the matrix from a gradient per voxel to one per mm of world
    Float3 world_x, world_y, world_z;           ///< rows of the matrix from voxels to the world, mm
    Float3 to_eye;                              ///< unit, world: against the camera's axis
    std::int32_t others;                        ///< lights beside this one
    LightView other[8];

    /// Unit, world, of a covector per voxel; 0 where it is.
    template <class F>
    CHIARO_INLINE Vec3<F> normal(Vec3<F> gradient) const {
        const Vec3<F> g = to_world(gradient);
        return inverse_length(g) * g;
    }

    /// Normal, and two-sided Lambert and Blinn-Phong factors, of a direction out of the surface given as a covector per
    /// voxel (any scale).
    template <class F>
    CHIARO_INLINE void reflect(Vec3<F> gradient, SamplePoint<F>& sample) const {
        const Vec3<F> g = to_world(gradient);
        const F inverse = inverse_length(g);
        const F nl = dot(g, Vec3<F>(to_light)) * inverse, nh = dot(g, Vec3<F>(half)) * inverse;
        sample.lambert = abs(nl);
        sample.rise = F(out) * nl;
        sample.outward = inverse * g;
        if (specular.x + specular.y + specular.z > 0)
            sample.highlight = pow(max(select(nl < F(0), F(0) - nh, nh), F(0)), F(shininess));
    }

    template <class F>
    CHIARO_INLINE Incident<F> local(const SamplePoint<F>& s) const {
        const Vec3<F> ambient_light(F{ambient}, F{ambient}, F{ambient});
        const Incident<F> lit{mad(s.lambert, Vec3<F>(diffuse), ambient_light), s.highlight * Vec3<F>(specular)};
        if (others == 0) return lit;
        const Vec3<F> p_voxel = s.p_voxel, normal = s.outward;  // of what has an address no other copy is in registers
        Incident<F> all = lit;
        add_others(*this, p_voxel, normal, all);
        return all;
    }

private:
    /// What reflect() and local() do, light by light; normals are two-sided here, too.
    template <class F>
    static CHIARO_NOINLINE void add_others(const ShadingView& shading, const Vec3<F>& p_voxel, const Vec3<F>& normal,
                                           Incident<F>& lit) {
        const Vec3<F> p{dot(Vec3<F>(shading.world_x), p_voxel), dot(Vec3<F>(shading.world_y), p_voxel),
                        dot(Vec3<F>(shading.world_z), p_voxel)};
        for (std::int32_t i = 0; i < shading.others; ++i) {
            const LightView& light = shading.other[i];
            Vec3<F> to_light(light.to_light), half(light.half);
            if (light.is_point) {
                to_light = to_light - p;
                to_light = inverse_length(to_light) * to_light;
                half = to_light + Vec3<F>(shading.to_eye);
                half = inverse_length(half) * half;
            }
            const F nl = dot(normal, to_light), nh = dot(normal, half);
            lit.diffuse = mad(abs(nl), Vec3<F>(light.diffuse), lit.diffuse);
            if (light.specular.x + light.specular.y + light.specular.z > 0) {
                const F shine = pow(max(select(nl < F(0), F(0) - nh, nh), F(0)), F(shading.shininess));
                lit.specular = mad(shine, Vec3<F>(light.specular), lit.specular);
            }
        }
    }
    template <class F>
    CHIARO_INLINE Vec3<F> to_world(Vec3<F> gradient) const {
        return {dot(Vec3<F>(gradient_x), gradient), dot(Vec3<F>(gradient_y), gradient),
                dot(Vec3<F>(gradient_z), gradient)};
    }
    template <class F>
    static CHIARO_INLINE F inverse_length(Vec3<F> g) {
        const F squared = dot(g, g);
        return select(squared > F(1e-24f), F(1) / sqrt(max(squared, F(1e-24f))), F(0));
    }
};

}  // namespace chiaro::kernel

// Natural light as the ray caster reads it: what of a probe's light arrives, per channel.
#pragma once
#include "illumination/transport/field.h"
#include "illumination/visibility/stored.h"
#include "illumination/visibility/surface_light.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Of visibility, whose light is found at the nodes, and of transport, whose nodes hold scattered light: one kind of
/// view, so that the ray caster is compiled for both at once.
struct VisibilityView {
    static constexpr bool modulates = true, adds_opacity = false;

    NodeLight light;  ///< E of the nodes

    StoredHarmonics harmonics;  ///< V of the nodes, where a surface is lit by its own normal
    SurfaceLight surface;       ///< then
    Strength strength;
    Float3 grid_x, grid_y, grid_z;  ///< axes of the grid in the world

    ScatteredLight scattered;
    CutLight cut_light;

    /// ρ E takes the place of ambient and diffuse light; highlights show it from the light's main direction.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading) const {
        if (scattered.on) {
            Incident<F> found;
            scatter(sample, shading, found);
            return found;
        }
        Vec3<F> e = light.at(sample.p_voxel);
        if (surface.entries) on_surfaces(sample, e);
        cut_light.shine_on(sample.cut, e);
        const F highlight = sample.highlight;
        return {e, Vec3<F>(highlight * e.x * F(shading.specular.x), highlight * e.y * F(shading.specular.y),
                           highlight * e.z * F(shading.specular.z))};
    }

private:
    template <class F>
    CHIARO_NOINLINE void scatter(const SamplePoint<F>& sample, const ShadingView& shading, Incident<F>& found) const {
        found = scattered.incident(light, cut_light, sample, shading);
    }

    /// By the sample's own normal, one lane after the other: there are few surfaces along a ray.
    template <class F>
    CHIARO_NOINLINE void on_surfaces(const SamplePoint<F>& sample, Vec3<F>& e) const {
        constexpr int lanes = LaneTraits<F>::count;
        const GridLocation<F> at = light.grid.locate(sample.p_voxel);
        std::int32_t node[lanes];
        __builtin_memcpy(node, &at.node, sizeof node);
        float t[3][lanes], n[3][lanes], out[3][lanes];
        store_row(t[0], at.t.x), store_row(t[1], at.t.y), store_row(t[2], at.t.z);
        store_row(n[0], dot(Vec3<F>(grid_x), sample.outward));
        store_row(n[1], dot(Vec3<F>(grid_y), sample.outward));
        store_row(n[2], dot(Vec3<F>(grid_z), sample.outward));
        for (int i = 0; i < lanes; ++i) {
            float visibility[16], sums[4] = {0, 0, 0, 0};
            visible_at(std::uint32_t(node[i]), {t[0][i], t[1][i], t[2][i]}, visibility);
            surface.add_to(sums, visibility, {n[0][i], n[1][i], n[2][i]}, 1);
            for (int k = 0; k < 3; ++k) out[k][i] = max(sums[k], 0.0f);
        }
        e = {load_row<F>(out[0]), load_row<F>(out[1]), load_row<F>(out[2])};
    }
    CHIARO_INLINE void visible_at(std::int64_t node, Float3 t, float* visibility) const {
        for (int c = 0; c < 16; ++c) visibility[c] = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const float weight =
                (corner & 1 ? t.x : 1 - t.x) * (corner & 2 ? t.y : 1 - t.y) * (corner & 4 ? t.z : 1 - t.z);
            if (!(weight > 0)) continue;
            float of_node[16];
            harmonics.load(
                node + (corner & 1) + (corner & 2 ? light.grid.row : 0) + (corner & 4 ? light.grid.slice : 0), of_node);
            for (int c = 0; c < 16; ++c) visibility[c] = mad(weight, of_node[c], visibility[c]);
        }
        strength.apply(visibility);
    }
};

}  // namespace chiaro::kernel

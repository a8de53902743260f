// Natural light as the ray caster reads it: what of a probe's light arrives, per channel.
#pragma once
#include "illumination/off_surface.h"
#include "illumination/probe/highlight_view.h"
#include "illumination/transport/field.h"
#include "illumination/visibility/crowded_nodes.h"
#include "illumination/visibility/stored.h"
#include "illumination/visibility/sun_light.h"
#include "illumination/visibility/surface_light.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Of visibility, whose light is found at the nodes, and of transport, whose nodes hold scattered light: one kind of
/// view, so that the ray caster is compiled for both at once.
struct VisibilityView {
    static constexpr bool modulates = true, adds_opacity = false, by_surface = true, remembers_surfaces = true;

    NodeLight light;  ///< E of the nodes, on particles

    GridView grid;              ///< of the nodes that V is kept for
    StoredHarmonics harmonics;  ///< V of them
    SurfaceLight surface;       ///< of surfaces, by their own normals: all but the sun's
    static constexpr std::int32_t max_suns = 2;
    SunLight suns[max_suns];
    Strength strength;
    OffSurface off_surface;
    float lift_edges;      ///< V is read so far off a surface
    CrowdedNodes crowded;  ///< where other matter is nearer than that

    ScatteredLight scattered;
    CutLight cut_light;
    HighlightView highlight;  ///< of surfaces

    CHIARO_INLINE bool asks_surfaces() const { return surface.entries; }

    /// ρ E takes the place of ambient and diffuse light. Highlights of surfaces show the probe around the mirrored eye;
    /// where no surfaces are asked for, E from the light's main direction.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading, const Mask<F>& visible,
                                       F step, MetSurface<F>& met) const {
        if (surface.entries) {
            const Mask<F> is_new = sample.surface.share > F(0);
            if (any(is_new)) meet(sample.surface, is_new, step, met);
        }
        Vec3<F> e = met.e;
        const Mask<F> of_particles = visible & (met.share < F(1));
        if (any(of_particles)) {
            const Vec3<F> around = scattered.on ? on_particles(sample) : light.at(sample.p_voxel);
            e = select(of_particles, mad(met.share, e - around, around), e);
        }
        cut_light.shine_on(sample.cut, e);
        if (surface.entries) return {e, met.share * met.shine};
        const F shine = scattered.on ? F(0) : sample.highlight;
        return {e, Vec3<F>(shine * e.x * F(shading.specular.x), shine * e.y * F(shading.specular.y),
                           shine * e.z * F(shading.specular.z))};
    }

    /// On particles, apart from any ray.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading) const {
        MetSurface<F> none;
        return incident(sample, shading, F(0) <= F(0), F(0), none);
    }

private:
    template <class F>
    CHIARO_NOINLINE Vec3<F> on_particles(const SamplePoint<F>& sample) const {
        return scattered.incident(light, sample);
    }

    /// Eight nodes of a grid for each lane, and their weights.
    template <int lanes>
    struct Corners {
        std::int32_t node[lanes];
        float weights[8][lanes];

        Corners() = default;
        template <class F>
        CHIARO_INLINE explicit Corners(const GridLocation<F>& at) {
            __builtin_memcpy(node, &at.node, sizeof node);
            for (int corner = 0; corner < 8; ++corner)
                store_row(weights[corner], (corner & 1 ? at.t.x : F(1) - at.t.x) *
                                               (corner & 2 ? at.t.y : F(1) - at.t.y) *
                                               (corner & 4 ? at.t.z : F(1) - at.t.z));
        }
        CHIARO_INLINE void of(int lane, const GridView& grid, std::int64_t (&nodes)[8], float (&own)[8]) const {
            const std::int32_t along_x = grid.last.x > 0;  // of one node there is no second
            for (int corner = 0; corner < 8; ++corner) {
                nodes[corner] = std::uint32_t(node[lane]) + (corner & 1 ? along_x : 0) + (corner & 2 ? grid.row : 0) +
                                (corner & 4 ? grid.slice : 0);
                own[corner] = weights[corner][lane];
            }
        }
    };

    /// By the surface's own normal, one lane after the other: there are few surfaces along a ray. V is read off it.
    template <class F>
    CHIARO_NOINLINE void meet(const SurfacePoint<F>& at_surface, const Mask<F>& wanted, F step,
                              MetSurface<F>& met) const {
        constexpr int lanes = LaneTraits<F>::count;
        const Vec3<F> normal = off_surface.along_grid(at_surface.normal);
        const auto off = [&](float edges, const Vec3<F>& way) {
            return off_surface.place(at_surface.p_voxel, F(edges) + at_surface.depth, way);
        };
        const auto of_normal = surface.locate(normal);
        const Vec3<F> read_at = off(lift_edges, normal);
        OfLanes<lanes> of(grid.locate(read_at));
        __builtin_memcpy(of.entry, &of_normal.entry, sizeof of.entry);
        for (int corner = 0; corner < 4; ++corner) store_row(of.entry_weights[corner], of_normal.weights[corner]);
        store_row(of.normal[0], normal.x), store_row(of.normal[1], normal.y), store_row(of.normal[2], normal.z);
        store_row(of.wanted, select(wanted, F(1), F(0)));
        store_row(of.outside, grid.outside(read_at));
        of.nearer = Corners<lanes>(grid.locate(off(crowded.lift_edges, normal)));
        for (std::int32_t sun = 0; sun < max_suns && suns[sun].nodes; ++sun) {
            const Vec3<F> way = suns[sun].way_off(normal);
            of.sun[sun] = Corners<lanes>(grid.locate(off(lift_edges, way)));
            of.sun_nearer[sun] = Corners<lanes>(grid.locate(off(crowded.lift_edges, way)));
        }
        if (scattered.around) {
            of.scattered.keep(off(scattered.lift_edges, normal));
            of.scattered_nearer.keep(off(scattered.hidden_lift_edges, normal));
        }
        store_row(of.reflected, F(0));
        if (highlight.radiance) {
            const auto mirrored = highlight.locate(at_surface.p_voxel, at_surface.normal);
            __builtin_memcpy(of.mirrored, &mirrored.cell.entry, sizeof of.mirrored);
            for (int corner = 0; corner < 4; ++corner)
                store_row(of.mirrored_weights[corner], mirrored.cell.weights[corner]);
            store_row(of.reflected, mirrored.reflected);
        }
        float e[6][lanes];
        for (int i = 0; i < lanes; ++i) {
            float lit[4] = {0, 0, 0, 0}, shown[3] = {0, 0, 0};
            if (of.wanted[i] > 0) shine<F>(of, i, lit, shown);
            for (int k = 0; k < 3; ++k) e[k][i] = lit[k], e[3 + k][i] = shown[k];
        }
        met = {select(wanted, at_surface.share, met.share), select(wanted, step, met.step),
               select(wanted, {load_row<F>(e[0]), load_row<F>(e[1]), load_row<F>(e[2])}, met.e),
               select(wanted, {load_row<F>(e[3]), load_row<F>(e[4]), load_row<F>(e[5])}, met.shine)};
    }

    /// A place of each lane, in voxel coordinates.
    template <int lanes>
    struct Places {
        float at[3][lanes];

        template <class F>
        CHIARO_INLINE void keep(const Vec3<F>& p) {
            store_row(at[0], p.x), store_row(at[1], p.y), store_row(at[2], p.z);
        }
        CHIARO_INLINE Vec3<float> of(int lane) const { return {at[0][lane], at[1][lane], at[2][lane]}; }
    };
    template <int lanes>
    struct OfLanes {
        Corners<lanes> seen, nearer, sun[max_suns], sun_nearer[max_suns];
        std::int32_t entry[lanes];
        float entry_weights[4][lanes], normal[3][lanes], wanted[lanes], outside[lanes];
        std::int32_t mirrored[lanes];
        float mirrored_weights[4][lanes], reflected[lanes];
        Places<lanes> scattered, scattered_nearer;

        /// The rest is left as it is: most of it is of no use to most views.
        template <class F>
        CHIARO_INLINE explicit OfLanes(const GridLocation<F>& seen_at) : seen(seen_at) {}
    };

    /// Eight nodes around one place, and their weights.
    struct Around {
        std::int64_t nodes[8];
        float weights[8];

        template <int lanes>
        CHIARO_INLINE Around(const Corners<lanes>& corners, int lane, const GridView& grid) {
            corners.of(lane, grid, nodes, weights);
        }
    };

    /// What of the light gets to a place: V, and the sun's share.
    template <class F>
    struct Arriving {
        typename NumbersOf<F>::Sixteen visibility;
        typename NumbersOf<F>::Four sun[max_suns];
    };
    /// Where other matter is among the nodes around the place off the surface, it is read nearer; and where that place
    /// lies beyond the last nodes all light arrives: there is nothing.
    template <class F, int lanes>
    CHIARO_INLINE Arriving<F> arriving(const OfLanes<lanes>& of, int i) const {
        using Four = typename NumbersOf<F>::Four;
        using Sixteen = typename NumbersOf<F>::Sixteen;
        const Around there(of.seen, i, grid);
        Arriving<F> arriving;
        arriving.visibility = harmonics.mix<Sixteen>(there.nodes, there.weights);
        for (std::int32_t sun = 0; sun < max_suns && suns[sun].nodes; ++sun)
            arriving.sun[sun] = sun_at<F>(sun, Around(of.sun[sun], i, grid));
        const float share = crowded.share(surface.seen(arriving.visibility), there.nodes, there.weights);
        if (!(share > 0)) return arriving;
        Around near(of.nearer, i, grid);
        crowded.weigh_by_air<Sixteen>(near.nodes, near.weights);
        const float outside = share * of.outside[i], of_far = 1 - share, of_near = share - outside;
        const float all[16] = {outside / surface.mean};
        const Sixteen mixed = Sixteen(of_near) * harmonics.mix<Sixteen>(near.nodes, near.weights);
        arriving.visibility = (Sixteen(of_far) * arriving.visibility + mixed) + loaded<Sixteen>(all);
        for (std::int32_t sun = 0; sun < max_suns && suns[sun].nodes; ++sun) {
            Around nearer(of.sun_nearer[sun], i, grid);
            crowded.weigh_by_air<Sixteen>(nearer.nodes, nearer.weights);
            arriving.sun[sun] =
                (Four(of_far) * arriving.sun[sun] + Four(of_near) * sun_at<F>(sun, nearer)) + Four(outside);
        }
        return arriving;
    }
    /// The share of each part of a sun.
    template <class F>
    CHIARO_INLINE auto sun_at(std::int32_t sun, const Around& around) const {
        return suns[sun].template arriving<typename NumbersOf<F>::Four>(around.nodes, around.weights);
    }
    template <class F, int lanes>
    CHIARO_INLINE void shine(const OfLanes<lanes>& of, int i, float* lit, float* shown) const {
        using Four = typename NumbersOf<F>::Four;
        using Sixteen = typename NumbersOf<F>::Sixteen;
        float entry_weights[4];
        for (int corner = 0; corner < 4; ++corner) entry_weights[corner] = of.entry_weights[corner][i];
        const float normal[3] = {of.normal[0][i], of.normal[1][i], of.normal[2][i]};
        const Arriving<F> here = arriving<F>(of, i);
        const float clear = 1 - strength.shown;
        Four whole, e = surface.shine<Four>(here.visibility, of.entry[i], entry_weights, strength.shown, clear, whole);
        for (std::int32_t sun = 0; sun < max_suns && suns[sun].nodes; ++sun)
            suns[sun].add_to(e, whole, here.sun[sun], normal, strength.shown, clear);
        float open[4], scatter[4] = {0, 0, 0, 0};
        store(e, lit), store(whole, open);
        if (scattered.around) {
            const Vec3<float> far = of.scattered.of(i), nearer = of.scattered_nearer.of(i);
            const float hidden = scattered.hidden(surface.seen(here.visibility));
            const Around around(Corners<1>(light.grid.locate(far + hidden * (nearer - far))), 0, light.grid);
            scattered.add_to<Sixteen>(scatter, around.nodes, around.weights, normal, surface.horizon(here.visibility));
        }
        if (highlight.radiance) {
            for (int corner = 0; corner < 4; ++corner) entry_weights[corner] = of.mirrored_weights[corner][i];
            highlight.add_to(shown, of.mirrored[i], entry_weights);
        }
        // Of the light around the mirrored eye as much arrives as of all that reaches the surface.
        const float reflected = of.reflected[i];
        for (int k = 0; k < 3; ++k) {
            const float arriving = open[k] > 1e-12f ? min(lit[k] / open[k], 1.0f) : 0.0f;
            shown[k] = reflected * mad(shown[k], arriving, scatter[k]);
            lit[k] = (1 - reflected) * (lit[k] + scatter[k]);
        }
    }
};

}  // namespace chiaro::kernel

// What rays travel through, and what every march asks of it.
#pragma once
#include "classify/surface_view.h"
#include "illumination/view.h"
#include "raycast/lattice.h"
#include "raycast/tables.h"
#include "volume/occupancy.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// How solid matter is by the opacity of a step.
struct SolidView {
    float from, slope;

    template <class F>
    CHIARO_INLINE F of(F alpha) const {
        return min(max((alpha - F(from)) * F(slope), F(0)), F(1));
    }
};

/// From extinction per mm to what a step shows of it, of mixtures: opacity, and the colour that is left of albedos.
struct StepOfMatter {
    float mm;
    float most;  ///< of a colour's largest channel

    template <class F>
    CHIARO_INLINE RgbaLanes<F> of(const RgbaLanes<F>& matter, bool additive) const {
        const F kappa = alpha_of(matter), depth = F(mm) * kappa;
        // 1 - exp(-x), of small x by its series.
        const F thin = depth * mad(depth, mad(depth, F(1.0f / 6), F(-0.5f)), F(1));
        const F thick = F(1) - exp2_below_0(F(-1.442695041f) * depth);
        const F alpha = additive ? depth : select(depth < F(0.03f), thin, thick);
        const F inverse = F(1) / max(kappa, F(1e-30f));
        return limited<F>(scale(matter, alpha * inverse), matter, inverse);
    }
    /// A colour whose albedo is that of `matter` times `inverse`, limited to `most`.
    template <class F>
    CHIARO_INLINE RgbaLanes<F> limited(const RgbaLanes<F>& colour, const RgbaLanes<F>& matter, F inverse) const {
        if (!(most < 1e30f)) return colour;
        const Vec3<F> rgb = colour_of(matter);
        const F largest = max(max(rgb.x, rgb.y), rgb.z) * inverse, left = min(F(most) / max(largest, F(1e-30f)), F(1));
        return light_up(colour, Vec3<F>{left, left, left}, Vec3<F>{F(0), F(0), F(0)});
    }
    /// Classified first: the colours of the eight voxels, interpolated.
    template <class F>
    CHIARO_INLINE RgbaLanes<F> interpolated(const EightMatters<F>& eight, Vec3<F> t) const {
        const auto along_x = [&](int first) CHIARO_INLINE_LAMBDA {
            return mix<F>(of<F>(eight.of[first], false), of<F>(eight.of[first + 1], false), t.x);
        };
        const RgbaLanes<F> low = mix<F>(along_x(0), along_x(2), t.y), high = mix<F>(along_x(4), along_x(6), t.y);
        return mix<F>(low, high, t.z);
    }
};

template <class Voxel, class Field>
struct Matter {
    VolumeView<Voxel> volume;
    OccupancyView occupancy;
    StepTableView table;
    OnsetTableView onsets;
    SegmentTableView segments;
    StepOfMatter step;  ///< of mixtures, in the place of the table
    LabelView labels;   ///< that lie in one channel; else null
    ShadingView shading;
    Field field;
    float cutoff;     ///< a ray ends below this transmittance
    float cut_alpha;  ///< a cut through more opaque matter shows the plane's normal
    SolidView solid;
    SurfaceView surface;  ///< of fields that are read by it
    ShareTableView shares;
    float met_steps;  ///< of a surface that was met, to what lies behind
    bool refines;     ///< lit rays, where colours change much
    bool skip_empty;
    bool shows_cuts;  ///< cuts through solid matter are lit by all that lies before them

    static constexpr bool is_paged = requires(const VolumeView<Voxel>& v) { v.table; };
    template <class F>
    using Held = std::conditional_t<is_paged, HeldBricks<F>, NoBricks>;

    static constexpr bool modulates = Field::modulates, adds_opacity = Field::adds_opacity;

    template <class F>
    CHIARO_INLINE F value_at(Vec3<F> p_clamped) const {
        return volume.value(volume.locate(p_clamped, volume.voxel(p_clamped)));
    }

    /// Of a step there.
    template <class F>
    CHIARO_INLINE F alpha_at(Vec3<F> p_clamped) const {
        const auto at = volume.locate(p_clamped, volume.voxel(p_clamped));
        if (volume.is_mixed()) return alpha_of(step.template of<F>(volume.matter_at(at), false));
        const F value = volume.value(at), alpha = alpha_of(table.at(value));
        return volume.has_factor() ? opacity_of_share(alpha, volume.factor_at(at, value)) : alpha;
    }

    /// For the lanes that have left the cube they knew: those in an empty cube are returned, and get as `next` the
    /// sample `behind` p, moved on by as many as the cube still holds; the others learn in `leave` where their occupied
    /// cube ends. Samples stay on the lattice.
    template <class F>
    CHIARO_INLINE Mask<F> skip_empty_cells(const Lattice<F>& lattice, Mask<F> lost, Vec3<F> p, VoxelIndex<F> voxel,
                                           F behind, F& next, F& leave, Held<F>& held) const {
        const Skip<F> skip = skip_from(lattice, lost, p, voxel, held);
        behind = behind + skip.steps;
        const Mask<F> empty = lost & skip.empty;
        leave = select(lost & !skip.empty, behind, leave);
        next = select(empty, behind, next);
        return empty;
    }

    /// Of a place that lies in no empty cube.
    template <class F>
    CHIARO_INLINE auto locate(Vec3<F> p, VoxelIndex<F> voxel, const Held<F>& held) const {
        if constexpr (is_paged)
            return volume.locate(p, voxel, held);
        else
            return volume.locate(p, voxel);
    }

    /// Where a sample lies along its ray.
    template <class F>
    struct Place {
        const Lattice<F>& lattice;
        F step;
        bool backwards;                     ///< the samples before it are not known yet
        const Vec3<F>* gradient = nullptr;  ///< of its values, where that is known
    };

    CHIARO_INLINE bool asks_surfaces() const {
        if constexpr (Field::by_surface) return field.asks_surfaces();
        return false;
    }
    CHIARO_INLINE bool asks_normals() const { return shading.enabled || asks_surfaces(); }

    /// Light that arrives at a sample and leaves it towards the eye.
    template <class At, class F>
    CHIARO_INLINE void light(const At& at, const Cut<F>& cut, const Mask<F>& visible, const Place<F>& place,
                             MetSurface<F>& met, SamplePoint<F> sample, RgbaLanes<F>& colour) const {
        if (!shading.enabled && !modulates) return;
        const bool asks_surfaces = this->asks_surfaces();
        if (shows_cuts) sample.cut = select(cut.open, cut.number, F(-1));
        if (asks_normals()) {
            const Vec3<F> gradient = place.gradient ? *place.gradient : volume.gradient(at);
            shading.reflect(select(cut.open, cut.normal, F(shading.out) * gradient), sample);
            if constexpr (Field::by_surface)
                if (asks_surfaces) find_surface(at, gradient, visible, cut.open, place, met, sample);
        }
        Incident<F> incident;
        if constexpr (Field::by_surface)
            incident = field.incident(sample, shading, visible, place.step, met);
        else
            incident = field.incident(sample, shading);
        colour = light_up(colour, incident.diffuse, incident.specular);
    }

private:
    template <class F>
    CHIARO_INLINE Skip<F> skip_from(const Lattice<F>& lattice, Mask<F> lost, Vec3<F> p, VoxelIndex<F> voxel,
                                    Held<F>& held) const {
        if constexpr (is_paged) {
            return volume.table.template skip<F>(lost, voxel, p, lattice.ahead, lattice.steps_per_voxel, held);
        } else {
            const Cube<F> cube = occupancy.around(voxel);
            return {cube.empty, steps_to_leave(cube, voxel, p, lattice.ahead, lattice.steps_per_voxel)};
        }
    }

    /// Of the sample alone; with its depth for fields that ask for it.
    template <class At, class F>
    CHIARO_INLINE SurfacePoint<F> own_surface(const At& at, const Vec3<F>& gradient, const Place<F>& place,
                                              const SamplePoint<F>& sample) const {
        SurfacePoint<F> own{F(1), sample.p_voxel,
                            towards_eye(sample.outward, F(shading.out) * dot(gradient, place.lattice.step))};
        if (shares.shares) {
            const auto node = shares.locate(sample.value, surface.slope_squared(gradient));
            own.share = shares.share(node);
            if (Field::remembers_surfaces) own.depth = shares.depth(node);
        } else if (surface.opacity) {  // isosurfaces are whole ones
            look_up_surface(at, gradient, sample.value, own);
        }
        return own;
    }
    template <class At, class F>
    CHIARO_NOINLINE void look_up_surface(const At& at, const Vec3<F>& gradient, const F& value,
                                         SurfacePoint<F>& own) const {
        const SurfaceAt<F> found = surface.of(volume, at, value, gradient);
        own.share = found.share, own.depth = found.depth;
    }

    /// A surface that was met reaches two edges far along its ray. Within the first of them light is looked up again
    /// only where there is more of a surface.
    template <class At, class F>
    CHIARO_INLINE void find_surface(const At& at, Vec3<F> gradient, const Mask<F>& visible, const Mask<F>& cut,
                                    const Place<F>& place, MetSurface<F>& met, SamplePoint<F>& sample) const {
        Mask<F> wanted = visible & !cut;
        if constexpr (!Field::remembers_surfaces) {
            sample.surface = own_surface(at, gradient, place, sample);
            sample.surface.share = select(wanted, sample.surface.share, F(0));
            return;
        }
        constexpr float more = 0.05f;
        const F since = place.backwards ? F(2 * met_steps) : place.step - met.step;
        met.share = select(visible & (since > F(met_steps)), F(0), met.share);
        const Mask<F> is_near = since < F(0.5f * met_steps);
        wanted = wanted & !(is_near & (met.share >= F(1 - more)));
        if (!any(wanted)) return;
        SurfacePoint<F> here = own_surface(at, gradient, place, sample);
        if (place.backwards && surface.opacity) look_before(wanted, place, here);
        const F least = met.share + select(is_near, F(more), F(0));
        here.share = select(wanted & (here.share >= least), here.share, F(0));
        sample.surface = here;
    }

    /// A normal of which the values' rise along the ray is told.
    template <class F>
    static CHIARO_INLINE Vec3<F> towards_eye(Vec3<F> normal, F rise) {
        return select(rise > F(0), F(-1), F(1)) * normal;
    }

    /// From back to front the surface that was met lies ahead: one and two edges nearer to the eye.
    template <class F>
    CHIARO_NOINLINE void look_before(Mask<F> wanted, const Place<F>& place, SurfacePoint<F>& met) const {
        for (int edges = 1; edges <= 2; ++edges) {
            const F step = place.step - F(0.5f * met_steps * float(edges));
            const Vec3<F> p = volume.clamp(place.lattice.position(max(step, F(0))));
            const SurfaceAt<F> found = surface.at(volume, p);
            const Mask<F> larger = wanted & (step >= F(0)) & (found.share > met.share);
            met = {select(larger, found.share, met.share), select(larger, p, met.p_voxel),
                   select(larger, towards_eye(shading.normal(found.gradient), dot(found.gradient, place.lattice.step)),
                          met.normal),
                   select(larger, found.depth, met.depth)};
        }
    }
};

}  // namespace chiaro::kernel

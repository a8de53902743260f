// The ray caster: emission and absorption along one ray, or sixteen (Max 1995; CS 247). One march loop for all.
#pragma once
#include "illumination/view.h"
#include "kernel/launch.h"
#include "kernel/rgba.h"
#include "raycast/lattice.h"
#include "volume/occupancy.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// Associated colours, corrected to the opacity of one step, over the stored values.
struct StepTableView {
    const Rgba* entries;
    float scale, offset;  ///< index = stored * scale + offset, rounding included
    float last;

    template <class F>
    CHIARO_INLINE Int<F> index(F stored) const {
        return truncate(min(max(mad(stored, F(scale), F(offset)), F(0)), F(last)));
    }
};

struct FrameView {
    Rgba* pixels;
    std::int32_t width;
};

/// Surfaces of one value each, in stored units, ascending; colours premultiplied.
struct SurfacesView {
    static constexpr int most = 8;
    float values[most];
    Rgba colours[most];
    std::int32_t count;
};

enum class March : std::int32_t { volume, surfaces, maximum };

template <class Voxel, class Field>
struct RaycastKernel {
    VolumeView<Voxel> volume;
    OccupancyView occupancy;
    StepTableView table;
    CameraView camera;
    ShadingView shading;
    Field field;
    FrameView frame;
    Float3 box_low, box_high;  ///< voxels
    ClipView clip_view;
    SurfacesView surfaces;
    const float* cell_high;  ///< largest stored value of each cell
    float highest;           ///< of the volume
    March mode;
    float step_mm;
    float cutoff;     ///< a ray ends below this transmittance
    float cut_alpha;  ///< a cut through more opaque matter shows the plane's normal
    bool skip_empty;

    /// Renders the block's pixels; returns the number of samples taken per lane.
    template <class F>
    CHIARO_INLINE Int<F> operator()(const PixelBlock<F>& block) const {
        const Ray<F> ray = camera.ray(to_float(block.column), to_float(block.row));
        Interval<F> hit = intersect(ray, box_low, box_high);
        const Cut<F> cut = clip(clip_view, ray, hit);
        const Lattice<F> lattice = make_lattice(ray, hit, step_mm);
        const Mask<F> alive = block.inside & (lattice.count > F(0));
        RgbaLanes<F> sum;
        zero(sum);
        Int<F> samples(0);
        if (mode == March::volume)
            samples = march(lattice, cut, alive, sum);
        else if (mode == March::surfaces)
            samples = march_to_surfaces(lattice, cut, alive, sum);
        else
            samples = march_for_maximum(lattice, alive, sum);
        store_block(sum, frame.pixels + std::int64_t(block.y) * frame.width + block.x, frame.width, block.inside);
        return samples;
    }

private:
    /// Emission and absorption, front to back.
    template <class F>
    CHIARO_INLINE Int<F> march(const Lattice<F>& lattice, const Cut<F>& cut, Mask<F> alive, RgbaLanes<F>& sum) const {
        F k(0), leave(0), transmittance(1);
        Int<F> samples(0);
        while (any(alive)) {
            const Vec3<F> p = volume.clamp(lattice.position(k));
            const VoxelIndex<F> voxel = volume.voxel(p);
            F next = k + F(1);
            Mask<F> sampled = alive;
            if (skip_empty) {
                const Mask<F> lost = alive & (k >= leave);
                if (any(lost)) {
                    sampled = alive & !leap(lattice, lost, p, voxel, next, leave);
                    if (!any(sampled)) {
                        k = next;
                        alive &= k < lattice.count;
                        continue;
                    }
                }
            }
            samples += select(sampled, Int<F>(1), Int<F>(0));
            sample(lattice, cut, sampled, k, volume.locate(p, voxel), p, transmittance, sum);
            k = next;
            alive &= (k < lattice.count) & (transmittance > F(cutoff));
        }
        return samples;
    }

    /// The first crossing of each surface's value between one sample and the next, the last of them at the exit. In an
    /// empty cube all values lie on one side of every surface, so behind it the side is still known.
    template <class F>
    CHIARO_INLINE Int<F> march_to_surfaces(const Lattice<F>& lattice, const Cut<F>& cut, Mask<F> alive,
                                           RgbaLanes<F>& sum) const {
        const F exit = lattice.full + lattice.rest;
        F k(0), leave(0), transmittance(1), before = value_at(volume.clamp(lattice.entry));
        enter_cut(lattice, cut, alive, before, transmittance, sum);
        Int<F> samples = select(alive, Int<F>(1), Int<F>(0));
        while (any(alive)) {
            const F steps = min(k + F(0.5f), exit);
            const Vec3<F> p = volume.clamp(lattice.at(steps));
            const VoxelIndex<F> voxel = volume.voxel(p);
            const F value = volume.value(volume.locate(p, voxel));
            samples += select(alive, Int<F>(1), Int<F>(0));
            const F from = max(steps - F(1), F(0));
            for (std::int32_t i = 0; i < surfaces.count; ++i)  // climbing rays meet the lowest value first
                cross(lattice, alive & (before < value), i, from, steps, before, value, transmittance, sum);
            for (std::int32_t i = surfaces.count - 1; i >= 0; --i)
                cross(lattice, alive & (before > value), i, from, steps, before, value, transmittance, sum);
            before = value;
            F next = k + F(1);
            const Mask<F> lost = alive & (k >= leave);
            if (skip_empty && any(lost)) leap(lattice, lost, p, voxel, next, leave);
            alive &= (k + F(0.5f) < exit) & (transmittance > F(cutoff));
            k = next;
        }
        return samples;
    }

    /// The largest value of the samples, shown as the transfer function shows one reference length of it.
    template <class F>
    CHIARO_INLINE Int<F> march_for_maximum(const Lattice<F>& lattice, Mask<F> alive, RgbaLanes<F>& sum) const {
        const Mask<F> seen = alive;
        F k(0), best(-3e38f);
        Int<F> samples(0);
        while (any(alive)) {
            const Vec3<F> p = volume.clamp(lattice.position(k));
            const VoxelIndex<F> voxel = volume.voxel(p);
            Mask<F> sampled = alive;
            F next = k + F(1);
            if (skip_empty) {
                const Mask<F> lower = gather_float(cell_high, occupancy.index(voxel)) <= best;
                sampled = alive & !lower;
                const Cube<F> cell{lower, F(0)};
                next =
                    select(lower, next + steps_to_leave(cell, voxel, p, lattice.ahead, lattice.steps_per_voxel), next);
            }
            if (any(sampled)) {
                samples += select(sampled, Int<F>(1), Int<F>(0));
                best = select(sampled, max(best, volume.value(volume.locate(p, voxel))), best);
            }
            k = next;
            alive &= (k < lattice.count) & (best < F(highest));
        }
        sum = accumulate(sum, select(seen, F(1), F(0)), load_rgba(table.entries, table.index(best)));
        return samples;
    }

    /// For the lanes that have left the cube they knew: those in an empty cube get the first sample behind it as `next`
    /// and are returned; the others learn in `leave` where their occupied cube ends. Samples stay on the lattice.
    template <class F>
    CHIARO_INLINE Mask<F> leap(const Lattice<F>& lattice, Mask<F> lost, Vec3<F> p, VoxelIndex<F> voxel, F& next,
                               F& leave) const {
        const Cube<F> cube = occupancy.around(voxel);
        const F behind = next + steps_to_leave(cube, voxel, p, lattice.ahead, lattice.steps_per_voxel);
        const Mask<F> empty = lost & cube.empty;
        leave = select(lost & !cube.empty, behind, leave);
        next = select(empty, behind, next);
        return empty;
    }

    /// Takes one sample: C += T c, T *= 1 - α, with c = α × colour.
    template <class F>
    CHIARO_INLINE void sample(const Lattice<F>& lattice, const Cut<F>& cut, Mask<F> sampled, F k, const Location<F>& at,
                              Vec3<F> p, F& transmittance, RgbaLanes<F>& sum) const {
        const F value = volume.value(at);
        RgbaLanes<F> colour = load_rgba(table.entries, table.index(value));
        F alpha = select(sampled, alpha_of(colour), F(0));
        const Mask<F> visible = alpha > F(0);
        if (!any(visible)) return;
        // The first half step behind a cut through solid matter has the plane's normal.
        const Cut<F> solid{cut.normal, Mask<F>(cut.open & (k < F(0.5f)) & (alpha > F(cut_alpha)))};
        shorten_last(lattice, visible & (k >= lattice.full), colour, alpha);
        if (shading.enabled || Field::modulates) light(at, solid, {p, value, F(0), F(0)}, colour);
        const F weight = select(visible, transmittance, F(0));
        sum = accumulate(sum, weight, colour);
        transmittance = transmittance - weight * alpha;
    }

    /// Opacity correction of the last, shorter step: 1 - (1 - α)^rest.
    template <class F>
    CHIARO_INLINE void shorten_last(const Lattice<F>& lattice, Mask<F> last, RgbaLanes<F>& colour, F& alpha) const {
        if (!any(last)) return;
        const F shorter = F(1) - pow(max(F(1) - alpha, F(0)), lattice.rest);
        const F ratio = select(last, shorter / max(alpha, F(1e-30f)), F(1));
        colour = scale(colour, ratio);
        alpha = alpha * ratio;
    }

    template <class F>
    CHIARO_INLINE F value_at(Vec3<F> p) const {
        return volume.value(volume.locate(p, volume.voxel(p)));
    }

    /// Composites surface i where it is crossed between `from` and `to` steps: bisected to 1/128 of a step, then
    /// linear.
    template <class F>
    CHIARO_INLINE void cross(const Lattice<F>& lattice, Mask<F> alive, std::int32_t i, F from, F to, F before, F value,
                             F& transmittance, RgbaLanes<F>& sum) const {
        const F surface(surfaces.values[i]);
        const Mask<F> below = before < surface;
        const Mask<F> crossed = alive & ((below & (value >= surface)) | ((!below) & (value < surface)));
        if (!any(crossed)) return;
        for (int halving = 0; halving < 7; ++halving) {
            const F middle = F(0.5f) * (from + to), between = value_at(volume.clamp(lattice.at(middle)));
            const Mask<F> same = (below & (between < surface)) | ((!below) & (between >= surface));
            from = select(same, middle, from), before = select(same, between, before);
            to = select(same, to, middle), value = select(same, value, between);
        }
        const F rise = value - before;
        const F share = select(abs(rise) > F(0), (surface - before) / select(abs(rise) > F(0), rise, F(1)), F(0.5f));
        const Cut<F> none{Vec3<F>(F(0), F(0), F(0)), F(0) > F(1)};
        show_surface(lattice.at(lerp(from, to, share)), none, crossed, i, transmittance, sum);
    }

    /// Where a ray enters a cut inside a surface, the surface lies in the plane.
    template <class F>
    CHIARO_INLINE void enter_cut(const Lattice<F>& lattice, const Cut<F>& cut, Mask<F> alive, F value, F& transmittance,
                                 RgbaLanes<F>& sum) const {
        const Mask<F> open = alive & cut.open;
        if (!any(open)) return;
        for (std::int32_t i = surfaces.count - 1; i >= 0; --i) {
            const Mask<F> inside = open & (value >= F(surfaces.values[i])) & (transmittance >= F(1));
            if (any(inside)) show_surface(lattice.entry, cut, inside, i, transmittance, sum);
        }
    }

    template <class F>
    CHIARO_INLINE void show_surface(Vec3<F> p, const Cut<F>& cut, Mask<F> hit, std::int32_t i, F& transmittance,
                                    RgbaLanes<F>& sum) const {
        p = volume.clamp(p);
        const Location<F> at = volume.locate(p, volume.voxel(p));
        RgbaLanes<F> colour = load_rgba(surfaces.colours, Int<F>(i));
        const F alpha(surfaces.colours[i].a);
        if (shading.enabled || Field::modulates) light(at, cut, {p, F(surfaces.values[i]), F(0), F(0)}, colour);
        const F weight = select(hit, transmittance, F(0));
        sum = accumulate(sum, weight, colour);
        transmittance = transmittance - weight * alpha;
    }

    template <class F>
    CHIARO_INLINE void light(const Location<F>& at, const Cut<F>& cut, SamplePoint<F> sample,
                             RgbaLanes<F>& colour) const {
        if (shading.enabled) {
            Vec3<F> g = volume.gradient(at);
            g = {select(cut.open, cut.normal.x, g.x), select(cut.open, cut.normal.y, g.y),
                 select(cut.open, cut.normal.z, g.z)};
            shading.reflect(g, sample.lambert, sample.highlight);
        }
        const Incident<F> incident = field.incident(sample, shading);
        colour = light_up(colour, incident.diffuse, incident.specular);
    }
};

}  // namespace chiaro::kernel

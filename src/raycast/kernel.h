// The ray caster: emission and absorption along one ray, or sixteen (Max 1995; CS 247). One march loop for all.
#pragma once
#include "illumination/view.h"
#include "kernel/launch.h"
#include "kernel/rgba.h"
#include "raycast/camera_view.h"
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

/// The samples of a ray: midpoints of steps from the entry on, the last one shortened to the exit.
template <class F>
struct Lattice {
    Vec3<F> entry, step;      ///< voxels
    Vec3<F> steps_per_voxel;  ///< magnitudes
    Vec3<F> ahead;            ///< a cell's edge where the ray climbs, else 0
    F full, rest, count;      ///< whole steps, the share of the last one, samples in all

    /// Voxel coordinates of sample k.
    CHIARO_INLINE Vec3<F> position(F k) const { return mad(min(k + F(0.5f), full + F(0.5f) * rest), step, entry); }
};

template <class F>
CHIARO_INLINE Lattice<F> make_lattice(const Ray<F>& ray, Interval<F> hit, float step_mm) {
    constexpr float negligible = 1e-4f;  // of a step
    Lattice<F> l;
    const F span = max(hit.far - hit.near, F(0)) * F(1 / step_mm);
    l.full = floor(span + F(negligible));
    l.rest = max(span - l.full, F(0));
    l.count = l.full + select(l.rest > F(negligible), F(1), F(0));
    l.entry = mad(hit.near, ray.direction, ray.origin);
    l.step = F(step_mm) * ray.direction;
    const Vec3<F> per_voxel{F(1) / away_from_zero(l.step.x), F(1) / away_from_zero(l.step.y),
                            F(1) / away_from_zero(l.step.z)};
    const auto edge_if_climbing = [](F d) CHIARO_INLINE_LAMBDA { return select(d > F(0), F(cell_edge), F(0)); };
    l.steps_per_voxel = {abs(per_voxel.x), abs(per_voxel.y), abs(per_voxel.z)};
    l.ahead = {edge_if_climbing(per_voxel.x), edge_if_climbing(per_voxel.y), edge_if_climbing(per_voxel.z)};
    return l;
}

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
    float step_mm;
    float cutoff;  ///< a ray ends below this transmittance
    bool skip_empty;

    /// Renders the block's pixels; returns the number of samples taken per lane.
    template <class F>
    CHIARO_INLINE Int<F> operator()(const PixelBlock<F>& block) const {
        const Ray<F> ray = camera.ray(to_float(block.column), to_float(block.row));
        const Lattice<F> lattice = make_lattice(ray, intersect(ray, box_low, box_high), step_mm);
        RgbaLanes<F> sum;
        zero(sum);
        const Int<F> samples = march(lattice, block.inside & (lattice.count > F(0)), sum);
        store_block(sum, frame.pixels + std::int64_t(block.y) * frame.width + block.x, frame.width, block.inside);
        return samples;
    }

private:
    template <class F>
    CHIARO_INLINE Int<F> march(const Lattice<F>& lattice, Mask<F> alive, RgbaLanes<F>& sum) const {
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
            sample(lattice, sampled, k, volume.locate(p, voxel), p, transmittance, sum);
            k = next;
            alive &= (k < lattice.count) & (transmittance > F(cutoff));
        }
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
    CHIARO_INLINE void sample(const Lattice<F>& lattice, Mask<F> sampled, F k, const Location<F>& at, Vec3<F> p,
                              F& transmittance, RgbaLanes<F>& sum) const {
        const F value = volume.value(at);
        RgbaLanes<F> colour = load_rgba(table.entries, table.index(value));
        F alpha = select(sampled, alpha_of(colour), F(0));
        const Mask<F> visible = alpha > F(0);
        if (!any(visible)) return;
        shorten_last(lattice, visible & (k >= lattice.full), colour, alpha);
        if (shading.enabled || Field::modulates) light(at, {p, value, F(0), F(0)}, colour);
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
    CHIARO_INLINE void light(const Location<F>& at, SamplePoint<F> sample, RgbaLanes<F>& colour) const {
        if (shading.enabled) shading.reflect(volume.gradient(at), sample.lambert, sample.highlight);
        const Incident<F> incident = field.incident(sample, shading);
        colour = light_up(colour, incident.diffuse, incident.specular);
    }
};

}  // namespace chiaro::kernel

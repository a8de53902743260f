// One value of a ray: the largest, smallest or mean of its samples, shown as the transfer function shows one reference
// length of it.
#pragma once
#include "raycast/composite.h"
#include "raycast/matter.h"

namespace chiaro::kernel {

/// What is looked for among stored values: the largest, or (sign -1) the smallest.
struct ExtremeView {
    const float* cell_bound;  ///< the same of each cell
    float bound;              ///< of the volume
    float sign;
};

/// Where labels show something.
template <class F, class Matter, class At>
CHIARO_INLINE Mask<F> shown_by_labels(const Matter& matter, const At& at, Mask<F> lanes) {
    if constexpr (requires { matter.volume.mixture; })
        if (matter.labels.distance) return lanes & (distance_at(matter.labels, at) >= F(0));
    return lanes;
}

/// A colour as labels have it where the value was found that it stands for.
template <class F, class Matter>
CHIARO_INLINE RgbaLanes<F> labelled_colour(const Matter& matter, Vec3<F> p, RgbaLanes<F> colour) {
    if constexpr (requires { matter.volume.mixture; }) {
        const LabelView& labels = matter.labels;
        if (!labels.cells) return colour;
        const auto at = matter.volume.locate(p, matter.volume.voxel(p));
        if (labels.share) colour = scale(colour, share_at(labels, at));
        if (labels.tint) colour = tinted(labels, at, colour);
    }
    return colour;
}

template <class F, class Matter, class Ray>
CHIARO_NOINLINE Int<F> march_for_extreme(const Matter& matter, const ExtremeView& extreme, const Lattice<F>& lattice,
                                         Mask<F> alive, Ray& ray) {
    Mask<F> seen = alive;
    Vec3<F> place{F(0), F(0), F(0)};
    const F sign(extreme.sign), bound(extreme.sign * extreme.bound);
    F k(0), best(-3e38f);  // times sign
    Int<F> samples(0);
    while (any(alive)) {
        const Vec3<F> p = matter.volume.clamp(lattice.position(k));
        const VoxelIndex<F> voxel = matter.volume.voxel(p);
        Mask<F> sampled = alive;
        F next = k + F(1);
        if (matter.skip_empty) {
            const Mask<F> lower = sign * gather_float(extreme.cell_bound, matter.occupancy.index(voxel)) <= best;
            sampled = alive & !lower;
            const Cube<F> cell{lower, F(0)};
            next = select(lower, next + steps_to_leave(cell, voxel, p, lattice.ahead, lattice.steps_per_voxel), next);
        }
        if (any(sampled)) {
            samples += select(sampled, Int<F>(1), Int<F>(0));
            const auto at = matter.volume.locate(p, voxel);
            const F value = sign * matter.volume.value(at);
            const Mask<F> larger = shown_by_labels<F>(matter, at, sampled & (value > best));
            ray.reach(larger, p);
            best = select(larger, value, best);
            place = {select(larger, p.x, place.x), select(larger, p.y, place.y), select(larger, p.z, place.z)};
        }
        k = next;
        alive &= (k < lattice.end) & (best < bound);
    }
    seen = seen & (best > F(-3e38f));
    const RgbaLanes<F> colour = labelled_colour<F>(matter, place, matter.table.at(sign * best));
    ray.add_behind(seen, colour, alpha_of(colour));
    return samples;
}

/// All samples count, the last as much as its step is long.
template <class F, class Matter, class Ray>
CHIARO_NOINLINE Int<F> march_for_mean(const Matter& matter, const Lattice<F>& lattice, Mask<F> alive, Ray& ray) {
    const Mask<F> seen = alive;
    F k(0), sum(0), length(0);
    Int<F> samples(0);
    while (any(alive)) {
        const F value = matter.value_at(matter.volume.clamp(lattice.position(k)));
        const F share = select(alive, select(k < lattice.full, F(1), lattice.rest), F(0));
        sum = mad(share, value, sum);
        length = length + share;
        samples += select(alive, Int<F>(1), Int<F>(0));
        k = k + F(1);
        alive &= k < lattice.end;
    }
    const RgbaLanes<F> colour = matter.table.at(sum / max(length, F(1e-30f)));
    ray.add_behind(seen, colour, alpha_of(colour));
    return samples;
}

}  // namespace chiaro::kernel

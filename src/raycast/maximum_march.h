// Maximum intensity: the largest value of the samples, shown as the transfer function shows one reference length of it.
#pragma once
#include "raycast/composite.h"
#include "raycast/matter.h"

namespace chiaro::kernel {

struct MaximumView {
    const float* cell_high;  ///< largest stored value of each cell
    float highest;           ///< of the volume
};

template <class F, class Matter, class Ray>
CHIARO_NOINLINE Int<F> march_for_maximum(const Matter& matter, const MaximumView& maximum, const Lattice<F>& lattice,
                                         Mask<F> alive, Ray& ray) {
    const Mask<F> seen = alive;
    F k(0), best(-3e38f);
    Int<F> samples(0);
    while (any(alive)) {
        const Vec3<F> p = matter.volume.clamp(lattice.position(k));
        const VoxelIndex<F> voxel = matter.volume.voxel(p);
        Mask<F> sampled = alive;
        F next = k + F(1);
        if (matter.skip_empty) {
            const Mask<F> lower = gather_float(maximum.cell_high, matter.occupancy.index(voxel)) <= best;
            sampled = alive & !lower;
            const Cube<F> cell{lower, F(0)};
            next = select(lower, next + steps_to_leave(cell, voxel, p, lattice.ahead, lattice.steps_per_voxel), next);
        }
        if (any(sampled)) {
            samples += select(sampled, Int<F>(1), Int<F>(0));
            const F value = matter.volume.value(matter.volume.locate(p, voxel));
            ray.reach(sampled & (value > best), p);
            best = select(sampled, max(best, value), best);
        }
        k = next;
        alive &= (k < lattice.end) & (best < F(maximum.highest));
    }
    const RgbaLanes<F> colour = matter.table.at(best);
    ray.add_behind(seen, colour, alpha_of(colour));
    return samples;
}

}  // namespace chiaro::kernel

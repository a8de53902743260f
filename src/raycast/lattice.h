// Where a ray takes its samples, and what of it a clip leaves.
#pragma once
#include "raycast/camera_view.h"
#include "volume/bricks.h"

namespace chiaro::kernel {

/// The half spaces that are kept: normal · p <= d, in voxel coordinates. A clip box is six of them.
struct ClipView {
    struct Plane {
        Float3 normal;
        float d;
    };
    static constexpr int most = 12;
    Plane planes[most];
    std::int32_t count;
};

/// The cut through which a ray enters: its normal as a gradient per voxel, and whether there is one.
template <class F>
struct Cut {
    Vec3<F> normal;
    Mask<F> open;
};

/// Shortens the interval to what the planes keep.
template <class F>
CHIARO_INLINE Cut<F> clip(const ClipView& view, const Ray<F>& ray, Interval<F>& i) {
    Cut<F> cut{Vec3<F>(F(0), F(0), F(0)), F(0) > F(1)};
    for (std::int32_t k = 0; k < view.count; ++k) {
        const Vec3<F> normal(view.planes[k].normal);
        const F along = away_from_zero(dot(normal, ray.direction));
        const F t = (F(view.planes[k].d) - dot(normal, ray.origin)) / along;
        const Mask<F> leaves = along > F(0), enters = (!leaves) & (t > i.near);
        i.far = select(leaves, min(i.far, t), i.far);
        i.near = select(enters, t, i.near);
        cut.normal = {select(enters, normal.x, cut.normal.x), select(enters, normal.y, cut.normal.y),
                      select(enters, normal.z, cut.normal.z)};
        cut.open = cut.open | enters;
    }
    return cut;
}

/// The samples of a ray: midpoints of steps from the entry on, the last one shortened to the exit.
template <class F>
struct Lattice {
    Vec3<F> entry, step;      ///< voxels
    Vec3<F> steps_per_voxel;  ///< magnitudes
    Vec3<F> ahead;            ///< a cell's edge where the ray climbs, else 0
    F full, rest;             ///< whole steps, the share of the last one
    F first, end;             ///< steps that are marched, [first, end)

    /// Voxel coordinates of sample k.
    CHIARO_INLINE Vec3<F> position(F k) const { return at(min(k + F(0.5f), full + F(0.5f) * rest)); }
    /// Voxel coordinates after a number of steps, of `full + rest` to the exit.
    CHIARO_INLINE Vec3<F> at(F steps) const { return mad(steps, step, entry); }
    CHIARO_INLINE F exit() const { return full + rest; }
    /// The same samples, met from the other side: `ahead` is what lies ahead then.
    CHIARO_INLINE Lattice reversed() const {
        Lattice l = *this;
        l.ahead = Vec3<F>(F(cell_edge), F(cell_edge), F(cell_edge)) - ahead;
        return l;
    }
};

template <class F>
CHIARO_INLINE Lattice<F> make_lattice(const Ray<F>& ray, Interval<F> hit, float step_mm) {
    constexpr float negligible = 1e-4f;  // of a step
    Lattice<F> l;
    const F span = max(hit.far - hit.near, F(0)) * F(1 / step_mm);
    l.full = floor(span + F(negligible));
    l.rest = max(span - l.full, F(0));
    l.first = F(0);
    l.end = l.full + select(l.rest > F(negligible), F(1), F(0));
    l.entry = mad(hit.near, ray.direction, ray.origin);
    l.step = F(step_mm) * ray.direction;
    const Vec3<F> per_voxel{F(1) / away_from_zero(l.step.x), F(1) / away_from_zero(l.step.y),
                            F(1) / away_from_zero(l.step.z)};
    const auto edge_if_climbing = [](F d) CHIARO_INLINE_LAMBDA { return select(d > F(0), F(cell_edge), F(0)); };
    l.steps_per_voxel = {abs(per_voxel.x), abs(per_voxel.y), abs(per_voxel.z)};
    l.ahead = {edge_if_climbing(per_voxel.x), edge_if_climbing(per_voxel.y), edge_if_climbing(per_voxel.z)};
    return l;
}

}  // namespace chiaro::kernel

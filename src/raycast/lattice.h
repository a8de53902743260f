// Where a ray takes its samples, and what of it a clip leaves.
#pragma once
#include "illumination/view.h"
#include "raycast/camera_view.h"
#include "volume/bricks.h"

namespace chiaro::kernel {

/// The half spaces that are kept: normal · p <= d, in voxel coordinates. A clip box is six of them.
struct ClipView {
    struct Plane {
        Float3 normal;
        float d;
    };
    static constexpr int most = clip_planes;
    Plane planes[most];
    std::int32_t count;
};

/// The cut through which a ray enters: its normal as a gradient per voxel, whether there is one, and which: a plane of
/// the clip, or a border of the volume.
template <class F>
struct Cut {
    Vec3<F> normal;
    Mask<F> open;
    F number;
};

/// Shortens the interval to what the planes keep.
template <class F>
CHIARO_INLINE Cut<F> clip(const ClipView& view, const Ray<F>& ray, Interval<F>& i) {
    Cut<F> cut{Vec3<F>(F(0), F(0), F(0)), F(0) > F(1), F(-1)};
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
        cut.number = select(enters, F(float(k)), cut.number);
    }
    return cut;
}

/// The border by which rays enter is a cut, too: of the axes the one on which the entry lies nearest to its border.
template <class F>
CHIARO_INLINE void enter_by_border(const Ray<F>& ray, Float3 low, Float3 high, F near, Mask<F> enters, Cut<F>& cut) {
    const Vec3<F> p = mad(near, ray.direction, ray.origin);
    const auto inside = [](F d, F at, float first, float last)
                            CHIARO_INLINE_LAMBDA { return abs(select(d > F(0), at - F(first), F(last) - at)); };
    const F x = inside(ray.direction.x, p.x, low.x, high.x), y = inside(ray.direction.y, p.y, low.y, high.y),
            z = inside(ray.direction.z, p.z, low.z, high.z);
    const Mask<F> by_x = (x <= y) & (x <= z), by_y = (!by_x) & (y <= z);
    const F d = select(by_x, ray.direction.x, select(by_y, ray.direction.y, ray.direction.z));
    const F out = select(d > F(0), F(-1), F(1)), axis = select(by_x, F(0), select(by_y, F(1), F(2)));
    const auto component = [&](float of) CHIARO_INLINE_LAMBDA { return select(axis == F(of), out, F(0)); };
    cut.normal = {select(enters, component(0), cut.normal.x), select(enters, component(1), cut.normal.y),
                  select(enters, component(2), cut.normal.z)};
    cut.number = select(enters, mad(F(2), axis, select(d > F(0), F(0), F(1))) + F(float(clip_planes)), cut.number);
    cut.open = cut.open | enters;
}

/// The part of a volume that a rank owns, in voxels: [low, high) along each axis; what reaches its border goes on.
struct OwnBox {
    Float3 low, high;
    std::int32_t before;  ///< steps that are taken before the first, for what they tell it
    std::int32_t on;      ///< 0: all is
};

/// The samples of a ray: midpoints of steps from the entry on, the last one shortened to the exit.
template <class F>
struct Lattice {
    Vec3<F> entry, step;      ///< voxels
    Vec3<F> steps_per_voxel;  ///< magnitudes
    Vec3<F> ahead;            ///< a cell's edge where the ray climbs, else 0
    F full, rest;             ///< whole steps, the share of the last one
    F first, end;             ///< steps that are marched, [first, end)
    Interval<F> own;          ///< of these, steps that count, where a volume is shown block by block

    /// Voxel coordinates of sample k.
    CHIARO_INLINE Vec3<F> position(F k) const { return middle(k, F(1)); }
    /// Of the middle of a step, or a part of one, that begins after k steps.
    CHIARO_INLINE Vec3<F> middle(F k, F length) const {
        return at(min(mad(F(0.5f), length, k), full + F(0.5f) * rest));
    }
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
    l.own = {F(0), F(3e38f)};
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

/// Steps [first, end) of those whose samples lie in the box: each step of a ray belongs to one of the boxes that a
/// volume is cut into, for where a plane parts two boxes both find the same step.
template <class F>
CHIARO_INLINE Interval<F> own_steps(const OwnBox& box, const Ray<F>& ray, F near_mm, float step_mm,
                                    const Lattice<F>& lattice) {
    Interval<F> steps{F(0), lattice.end};
    const auto cut = [&](F origin, F direction, float low, float high) CHIARO_INLINE_LAMBDA {
        const F inverse = F(1) / away_from_zero(direction);
        const auto step_behind = [&](float plane) CHIARO_INLINE_LAMBDA {
            const F at = ((F(plane) - origin) * inverse - near_mm) * F(1 / step_mm) + F(0.5f);
            return floor(min(max(at, F(0)), F(1e7f)));
        };
        const F a = step_behind(low), b = step_behind(high);
        const Mask<F> climbs = away_from_zero(direction) > F(0);
        steps.near = max(steps.near, select(climbs, a, b));
        steps.far = min(steps.far, select(climbs, b, a));
    };
    cut(ray.origin.x, ray.direction.x, box.low.x, box.high.x);
    cut(ray.origin.y, ray.direction.y, box.low.y, box.high.y);
    cut(ray.origin.z, ray.direction.z, box.low.z, box.high.z);
    return steps;
}

}  // namespace chiaro::kernel

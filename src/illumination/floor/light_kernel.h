// The light on a floor: what of each direction's light comes through the volume, for a point, or sixteen.
#pragma once
#include "illumination/cells/place.h"
#include "kernel/math.h"
#include "kernel/ray.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// A direction, and the light that it stands for: what it adds to E/π of an open floor.
struct FloorRay {
    Float3 direction;  ///< voxels per mm
    float light[3];
};

struct FloorLightKernel {
    const float* depth;  ///< optical depth of a node's edge; one spare number at the end
    GridView grid;
    Float3 low, high;  ///< voxels: around all nodes that hold something
    const FloorRay* rays;
    std::int32_t ray_count;
    float step_mm, per_step;  ///< a step, and in node edges
    float strength;           ///< of shadows

    static constexpr float dark = 7;  ///< more than this depth is not followed

    /// Adds up E/π at points `p` (voxels) for the three channels.
    template <class F>
    CHIARO_INLINE void operator()(Vec3<F> p, F (&light)[3]) const {
        for (F& channel : light) channel = F(0);
        for (std::int32_t k = 0; k < ray_count; ++k) {
            const FloorRay& ray = rays[k];
            const F open = F(1) - F(strength) * (F(1) - transmittance(p, Vec3<F>(ray.direction)));
            for (int c = 0; c < 3; ++c) light[c] = mad(open, F(ray.light[c]), light[c]);
        }
    }

private:
    template <class F>
    CHIARO_INLINE F transmittance(Vec3<F> p, Vec3<F> d) const {
        const Interval<F> way = intersect(Ray<F>{p, d}, low, high);
        F through(0);
        F t = way.near + F(0.5f * step_mm);
        for (;;) {
            const Mask<F> inside = (t < way.far) & (through < F(dark));
            if (!any(inside)) return exp2(F(-1.442695041f) * through);
            const GridLocation<F> at = grid.locate(mad(t, d, p));
            const auto v = gather_two(depth, typename GatherIndex<F>::type(at.node), grid.rows());
            const F here = trilinear<F>({v.a.a, v.b.a, v.c.a, v.d.a}, {v.a.b, v.b.b, v.c.b, v.d.b}, at.t);
            through = select(inside, mad(F(per_step), here, through), through);
            t = t + F(step_mm);
        }
    }
};

/// Of points side by side; `light` has three rows as long as theirs.
struct FloorPoints {
    const float *x, *y, *z;
    float* light[3];
};

template <class F>
CHIARO_INLINE void light_floor(const FloorLightKernel& kernel, const FloorPoints& points, std::int64_t first) {
    F light[3];
    kernel(Vec3<F>{load_row<F>(points.x + first), load_row<F>(points.y + first), load_row<F>(points.z + first)}, light);
    for (int c = 0; c < 3; ++c) store_row(points.light[c] + first, light[c]);
}

using FloorLightFunction = void (*)(const FloorLightKernel&, const FloorPoints&, std::int64_t first, std::int64_t end);

}  // namespace chiaro::kernel

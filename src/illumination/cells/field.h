// Accessibility as the ray caster reads it: one number a cell scales all the light that arrives.
#pragma once
#include "illumination/view.h"
#include "kernel/gather.h"

namespace chiaro::kernel {

struct AccessView {
    static constexpr bool modulates = true, adds_opacity = false;

    const std::uint16_t* cells;           ///< x fastest, 65535: all light arrives
    std::int32_t row, slice;              ///< distances along y and z; 0 along an axis of one cell
    Float3 last;                          ///< count - 1 per axis
    std::int32_t last_x, last_y, last_z;  ///< last interval's cell, max(count - 2, 0)
    Float3 cells_per_voxel, shift;        ///< cell = voxel × cells_per_voxel + shift
    float strength;

    /// A' = 1 - strength (1 - A), which scales ambient, diffuse and specular light alike.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading) const {
        const F access = F(1) - F(strength) * (F(1) - at(sample.p_voxel));
        const Incident<F> local = shading.local(sample);
        return {access * local.diffuse, access * local.specular};
    }

    /// Trilinear.
    template <class F>
    CHIARO_INLINE F at(Vec3<F> p_voxel) const {
        const Vec3<F> p{to_cell(p_voxel.x, cells_per_voxel.x, shift.x, last.x),
                        to_cell(p_voxel.y, cells_per_voxel.y, shift.y, last.y),
                        to_cell(p_voxel.z, cells_per_voxel.z, shift.z, last.z)};
        using I = Int<F>;
        const I x = min(truncate(p.x), I(last_x)), y = min(truncate(p.y), I(last_y)), z = min(truncate(p.z), I(last_z));
        const Vec3<F> t{p.x - to_float(x), p.y - to_float(y), p.z - to_float(z)};
        const auto v = gather_two(cells, typename GatherIndex<F>::type(z * I(slice) + y * I(row) + x),
                                  {0, row, slice, slice + row});
        const F near = lerp(lerp(v.a.a, v.a.b, t.x), lerp(v.b.a, v.b.b, t.x), t.y);
        const F far = lerp(lerp(v.c.a, v.c.b, t.x), lerp(v.d.a, v.d.b, t.x), t.y);
        return lerp(near, far, t.z) * F(1.0f / 65535);
    }

private:
    template <class F>
    static CHIARO_INLINE F to_cell(F voxel, float scale, float offset, float highest) {
        return min(max(mad(voxel, F(scale), F(offset)), F(0)), F(highest));
    }
};

}  // namespace chiaro::kernel

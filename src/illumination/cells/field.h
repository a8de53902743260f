// Accessibility as the ray caster reads it: one number a cell scales all the light that arrives.
#pragma once
#include "illumination/cells/place.h"
#include "illumination/view.h"

namespace chiaro::kernel {

struct AccessView {
    static constexpr bool modulates = true, adds_opacity = false, by_surface = false;

    const std::uint16_t* cells;  ///< x fastest, 65535: all light arrives
    GridView grid;
    float strength;

    /// A' = 1 - strength (1 - A), which scales ambient, diffuse and specular light alike.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading) const {
        const F arriving = select(sample.cut < F(0), at(sample.p_voxel), F(1));  // nothing lies before a cut
        const F access = F(1) - F(strength) * (F(1) - arriving);
        const Incident<F> local = shading.local(sample);
        return {access * local.diffuse, access * local.specular};
    }

    template <class F>
    CHIARO_INLINE F at(Vec3<F> p_voxel) const {
        return share_at(cells, grid, p_voxel);
    }
};

}  // namespace chiaro::kernel

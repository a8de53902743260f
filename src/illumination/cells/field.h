// Accessibility as the ray caster reads it: one number a cell scales all the light that arrives.
#pragma once
#include "illumination/cells/place.h"
#include "illumination/off_surface.h"
#include "illumination/view.h"

namespace chiaro::kernel {

/// How open surfaces are, by shares A / (1 + q) of the cells around (cells/surface_share.h): x = 2 A / (1 + q) is 1
/// over an open flat surface where A is right, and min(1, x (gain + more x)) is shown.
struct SurfaceAccess {
    float lift_edges;  ///< so far off a sample of a surface it is read
    float gain, more;
};

struct AccessView {
    static constexpr bool modulates = true, adds_opacity = false, by_surface = true, remembers_surfaces = false;

    const std::uint16_t* cells;  ///< x fastest, 65535: all light arrives
    GridView grid;
    float strength;
    bool of_surfaces;  ///< cells hold A / (1 + q), and samples of surfaces read them off those; else A
    SurfaceAccess surface;
    OffSurface off_surface;

    CHIARO_INLINE bool asks_surfaces() const { return of_surfaces; }

    /// A' = 1 - strength (1 - A), which scales ambient, diffuse and specular light alike. No surface is remembered
    /// along a ray: several ranks find the same of each sample.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading, const Mask<F>&, F,
                                       MetSurface<F>&) const {
        if (!of_surfaces) return shown(at(sample.p_voxel), sample, shading);
        const F share = sample.surface.share, here = F(2) * at(place(sample));
        const F open = here * mad(share, mad(F(surface.more), here, F(surface.gain - 1)), F(1));
        return shown(min(open, F(1)), sample, shading);
    }
    /// Apart from any ray, and from surfaces.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading) const {
        return shown(min(at(sample.p_voxel) * F(of_surfaces ? 2 : 1), F(1)), sample, shading);
    }

    /// What cells hold.
    template <class F>
    CHIARO_INLINE F at(Vec3<F> p_voxel) const {
        return share_at(cells, grid, p_voxel);
    }

private:
    /// Where a sample reads: the more of a surface it is, the farther off.
    template <class F>
    CHIARO_INLINE Vec3<F> place(const SamplePoint<F>& sample) const {
        const SurfacePoint<F>& its = sample.surface;
        const Mask<F> is_surface = its.share > F(0);
        if (!any(is_surface)) return sample.p_voxel;
        const F edges = its.share * F(surface.lift_edges);
        return select(is_surface, off_surface.place(its.p_voxel, edges, off_surface.along_grid(its.normal)),
                      sample.p_voxel);
    }
    template <class F>
    CHIARO_INLINE Incident<F> shown(F open, const SamplePoint<F>& sample, const ShadingView& shading) const {
        const F arriving = select(sample.cut < F(0), open, F(1));  // nothing lies before a cut
        const F access = F(1) - F(strength) * (F(1) - arriving);
        const Incident<F> local = shading.local(sample);
        return {access * local.diffuse, access * local.specular};
    }
};

}  // namespace chiaro::kernel

// What rays travel through, and what every march asks of it.
#pragma once
#include "illumination/view.h"
#include "raycast/lattice.h"
#include "raycast/tables.h"
#include "volume/occupancy.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// How solid matter is by the opacity of a step.
struct SolidView {
    float from, slope;

    template <class F>
    CHIARO_INLINE F of(F alpha) const {
        return min(max((alpha - F(from)) * F(slope), F(0)), F(1));
    }
};

template <class Voxel, class Field>
struct Matter {
    VolumeView<Voxel> volume;
    OccupancyView occupancy;
    StepTableView table;
    SegmentTableView segments;
    ShadingView shading;
    Field field;
    float cutoff;     ///< a ray ends below this transmittance
    float cut_alpha;  ///< a cut through more opaque matter shows the plane's normal
    SolidView solid;
    bool skip_empty;
    bool shows_cuts;  ///< cuts through solid matter are lit by all that lies before them

    static constexpr bool modulates = Field::modulates, adds_opacity = Field::adds_opacity;

    template <class F>
    CHIARO_INLINE F value_at(Vec3<F> p_clamped) const {
        return volume.value(volume.locate(p_clamped, volume.voxel(p_clamped)));
    }

    /// For the lanes that have left the cube they knew: those in an empty cube are returned, and get as `next` the
    /// sample `behind` p, moved on by as many as the cube still holds; the others learn in `leave` where their occupied
    /// cube ends. Samples stay on the lattice.
    template <class F>
    CHIARO_INLINE Mask<F> skip_empty_cells(const Lattice<F>& lattice, Mask<F> lost, Vec3<F> p, VoxelIndex<F> voxel,
                                           F behind, F& next, F& leave) const {
        const Cube<F> cube = occupancy.around(voxel);
        behind = behind + steps_to_leave(cube, voxel, p, lattice.ahead, lattice.steps_per_voxel);
        const Mask<F> empty = lost & cube.empty;
        leave = select(lost & !cube.empty, behind, leave);
        next = select(empty, behind, next);
        return empty;
    }

    /// Light that arrives at a sample and leaves it towards the eye.
    template <class At, class F>
    CHIARO_INLINE void light(const At& at, const Cut<F>& cut, SamplePoint<F> sample, RgbaLanes<F>& colour) const {
        if (!shading.enabled && !modulates) return;
        if (shows_cuts) sample.cut = select(cut.open, cut.number, F(-1));
        if (shading.enabled) {
            Vec3<F> g = volume.gradient(at);
            const F out(shading.out);
            g = {select(cut.open, cut.normal.x, out * g.x), select(cut.open, cut.normal.y, out * g.y),
                 select(cut.open, cut.normal.z, out * g.z)};
            shading.reflect(g, sample);
        }
        const Incident<F> incident = field.incident(sample, shading);
        colour = light_up(colour, incident.diffuse, incident.specular);
    }
};

}  // namespace chiaro::kernel

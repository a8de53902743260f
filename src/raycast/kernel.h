// The ray caster: one ray, or sixteen, from the camera through what the mode shows.
#pragma once
#include "kernel/launch.h"
#include "raycast/maximum_march.h"
#include "raycast/surface_march.h"
#include "raycast/volume_march.h"

namespace chiaro::kernel {

struct FrameView {
    Rgba* pixels;
    std::int32_t width;
};

enum class March : std::int32_t { volume, surfaces, maximum };

template <class Voxel, class Field>
struct RaycastKernel {
    Matter<Voxel, Field> matter;
    CameraView camera;
    FrameView frame;
    Float3 box_low, box_high;  ///< voxels
    ClipView clip_view;
    SurfacesView surfaces;
    MaximumView maximum;
    March mode;
    AnyWay way;  ///< of March::volume
    float step_mm;

    /// Renders the block's pixels; returns the number of samples taken per lane.
    template <class F>
    CHIARO_INLINE Int<F> operator()(const PixelBlock<F>& block) const {
        const Ray<F> ray = camera.ray(to_float(block.column), to_float(block.row));
        Interval<F> hit = intersect(ray, box_low, box_high);
        const Cut<F> cut = clip(clip_view, ray, hit);
        const Lattice<F> lattice = make_lattice(ray, hit, step_mm);
        const Mask<F> alive = block.inside & (lattice.end > F(0));
        Composite<F> composite;
        const Int<F> samples = march(lattice, cut, alive, composite);
        store_block(composite.sum, frame.pixels + std::int64_t(block.y) * frame.width + block.x, frame.width,
                    block.inside);
        return samples;
    }

private:
    template <class F>
    CHIARO_INLINE Int<F> march(const Lattice<F>& lattice, const Cut<F>& cut, Mask<F> alive,
                               Composite<F>& composite) const {
        if (mode == March::surfaces) return march_to_surfaces(matter, surfaces, lattice, cut, alive, composite);
        if (mode == March::maximum) return march_for_maximum(matter, maximum, lattice, alive, composite);
        if (way.classification == UsualWay::classification && way.backwards == UsualWay::backwards)
            return march_volume(matter, UsualWay{}, lattice, cut, alive, composite);
        return march_any_way(matter, way, lattice, cut, alive, composite);
    }
};

}  // namespace chiaro::kernel

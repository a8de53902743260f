// The ray caster: one ray, or sixteen, from the camera through what the mode shows.
#pragma once
#include "kernel/launch.h"
#include "raycast/ray_bounds.h"
#include "raycast/surface_march.h"
#include "raycast/value_march.h"
#include "raycast/volume_march.h"

namespace chiaro::kernel {

struct FrameView {
    Rgba* pixels;
    std::int32_t width;
    const float* ends_mm = nullptr;  ///< of each pixel's rays; null: none ends before the volume does
};

enum class March : std::int32_t { volume, surfaces, extreme, mean };

template <class Voxel, class Field>
struct RaycastKernel {
    Matter<Voxel, Field> matter;
    CameraView camera;
    FrameView frame;
    Float3 box_low, box_high;  ///< voxels
    ClipView clip_view;
    SurfacesView surfaces;
    ExtremeView extreme;
    March mode;
    MarchOptions way;  ///< of March::volume
    float step_mm;
    std::int32_t rays_per_pixel;
    BoundsView bounds;  ///< of the tile
    OwnBox own;

    /// Renders the block's pixels; returns the number of samples taken per lane.
    template <class F>
    CHIARO_INLINE Int<F> operator()(const PixelBlock<F>& block) const {
        RgbaLanes<F> sum;
        zero(sum);
        Int<F> samples(0);
        for (std::int32_t i = 0; i < rays_per_pixel; ++i) samples += cast_ray(block, i, sum);
        store_block(sum, frame.pixels + std::int64_t(block.y) * frame.width + block.x, frame.width, block.inside);
        return samples;
    }

    /// Hands the ray, a Composite or another, what it meets of what the mode shows.
    template <class F, class Ray>
    CHIARO_INLINE Int<F> march(const Lattice<F>& lattice, const Cut<F>& cut, Mask<F> alive, Ray& ray) const {
        if (mode == March::surfaces) return march_to_surfaces(matter, surfaces, lattice, cut, alive, ray);
        if (mode == March::extreme) return march_for_extreme(matter, extreme, lattice, alive, ray);
        if (mode == March::mean) return march_for_mean(matter, lattice, alive, ray);
        alive &= lattice.first < lattice.end;
        if (way.is(CommonMarch())) return march_volume(matter, CommonMarch{}, lattice, cut, alive, ray);
        if constexpr (requires { matter.volume.mixture; })
            if (way.is(LabelledMarch())) return march_apart(matter, LabelledMarch{}, lattice, cut, alive, ray);
        return march_apart(matter, way, lattice, cut, alive, ray);
    }

    /// Where the block's rays are in the box, and end.
    template <class F>
    CHIARO_INLINE Interval<F> hit(const PixelBlock<F>& block, const Ray<F>& ray) const {
        Interval<F> i = intersect(ray, box_low, box_high);
        if (!frame.ends_mm) return i;
        const Int<F> pixel = block.row * Int<F>(frame.width) + block.column;
        i.far = min(i.far, gather_float(frame.ends_mm, select(block.inside, pixel, Int<F>(0))));
        return i;
    }

    /// Of the rank's own block, and a few steps before it. Apart and by value: whole volumes keep their registers.
    template <class F>
    CHIARO_NOINLINE Lattice<F> of_own_block(Ray<F> ray, F near_mm, Lattice<F> lattice) const {
        lattice.own = own_steps(own, ray, near_mm, step_mm, lattice);
        lattice.first = max(lattice.first, lattice.own.near - F(float(own.before)));
        lattice.end = min(lattice.end, lattice.own.far);
        return lattice;
    }

private:
    /// Over the lens rays lie on a sunflower's spiral, turned from pixel to pixel by interleaved gradient noise
    /// (Jimenez 2014): blur has a fine grain in the place of ghosts.
    template <class F>
    CHIARO_INLINE Ray<F> lens_ray(F column, F row, std::int32_t i, SubPixel offset) const {
        const auto fraction = [](F x) CHIARO_INLINE_LAMBDA { return x - floor(x); };
        const F turn = fraction(F(52.9829189f) * fraction(mad(F(0.06711056f), column, F(0.00583715f) * row)));
        const F radius((float(i) + 0.5f) / float(rays_per_pixel));
        return ray_through_lens(camera, column + F(offset.x), row + F(offset.y), radius,
                                fraction(F(0.618034f * float(i)) + turn));
    }

    /// Adds ray i's share of its pixel.
    template <class F>
    CHIARO_INLINE Int<F> cast_ray(const PixelBlock<F>& block, std::int32_t i, RgbaLanes<F>& sum) const {
        const SubPixel offset = sub_pixel(i, rays_per_pixel);
        const F column = to_float(block.column), row = to_float(block.row);
        const Ray<F> ray =
            camera.lens_mm > 0 ? lens_ray(column, row, i, offset) : camera.ray(column + F(offset.x), row + F(offset.y));
        Interval<F> hit = this->hit(block, ray);
        const Mask<F> from_outside = hit.near > F(0);
        Cut<F> cut = clip(clip_view, ray, hit);
        if (matter.shows_cuts && mode == March::volume)
            if (const Mask<F> enters = from_outside & !cut.open; any(enters))
                enter_by_border(ray, box_low, box_high, hit.near, enters, cut);
        Lattice<F> lattice = make_lattice(ray, hit, step_mm);
        const Mask<F> alive = block.inside & (lattice.end > F(0));
        if (bounds.near_mm) bounds.narrow(block.column, block.row, i, hit.near, step_mm, lattice);
        if (own.on) lattice = of_own_block(ray, hit.near, lattice);
        Composite<F> composite;
        const Int<F> samples = march(lattice, cut, alive, composite);
        if (way.additive) composite.sum = limit_alpha<F>(composite.sum);
        sum = accumulate(sum, F(1 / float(rays_per_pixel)), composite.sum);
        return samples;
    }
};

}  // namespace chiaro::kernel

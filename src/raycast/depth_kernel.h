// How far it is to what is seen: the ray caster's marches, without light, until half of a ray's opacity is reached.
#pragma once
#include "illumination/none/field.h"
#include "raycast/kernel.h"

namespace chiaro::kernel {

/// What a ray gathers of opacity alone, and the sample that brings it to ½.
template <class F>
struct HalfOpacity {
    F transmittance{1};
    Vec3<F> here{F(0), F(0), F(0)}, reached{F(0), F(0), F(0)};  ///< voxels
    F share{0};                                                 ///< of the step around `reached` that lies before ½
    Mask<F> found = F(0) > F(1);

    CHIARO_INLINE void reach(Mask<F> where, const Vec3<F>& p) {
        here = {select(where, p.x, here.x), select(where, p.y, here.y), select(where, p.z, here.z)};
    }

    /// Within a step extinction is constant: T falls as (1 - α)^share.
    CHIARO_INLINE void add_behind(Mask<F> where, const RgbaLanes<F>&, F alpha) {
        const F behind = transmittance * select(where, max(F(1) - alpha, F(1e-20f)), F(1));
        const Mask<F> now = (transmittance > F(0.5f)) & (behind <= F(0.5f));
        if (any(now)) {
            const F part = log2(F(2) * transmittance) / log2(transmittance / behind);
            share = select(now, part, share);
            reached = {select(now, here.x, reached.x), select(now, here.y, reached.y), select(now, here.z, reached.z)};
            found = found | now;
        }
        transmittance = behind;
    }
    CHIARO_INLINE void add_emission(Mask<F>, const RgbaLanes<F>&) {}
    CHIARO_INLINE void add(bool, Mask<F> where, const RgbaLanes<F>& colour, F alpha) {
        add_behind(where, colour, alpha);
    }
};

/// The ray caster's kernel that fills pixels with a depth in mm, four times, or infinity: of the ray through a pixel's
/// centre. Its cutoff is ½, its order front to back.
template <class Voxel>
struct DepthKernel : RaycastKernel<Voxel, NoneView> {
    Rgba one{1, 1, 1, 1};

    template <class F>
    CHIARO_INLINE Int<F> operator()(const PixelBlock<F>& block) const {
        const auto ray = this->camera.ray(to_float(block.column), to_float(block.row));
        Interval<F> hit = this->hit(block, ray);
        const Cut<F> cut = clip(this->clip_view, ray, hit);
        Lattice<F> lattice = make_lattice(ray, hit, this->step_mm);
        if (this->own.on) lattice = this->of_own_block(ray, hit.near, lattice);
        HalfOpacity<F> half;
        const Int<F> samples = this->march(lattice, cut, block.inside & (lattice.end > F(0)), half);
        F depth = dot(half.reached - ray.origin, ray.direction) / dot(ray.direction, ray.direction);
        if (this->mode == March::volume) {  // from the middle of a step, the last of which is shorter
            const F step = min(F(this->step_mm), max(F(2) * (hit.far - depth), F(0)));
            depth = mad(half.share - F(0.5f), step, depth);
        }
        depth = select(half.found, depth, F(__builtin_inff()));
        RgbaLanes<F> pixel;
        zero(pixel);
        pixel = accumulate(pixel, depth, load_rgba(&one, Int<F>(0)));
        store_block(pixel, this->frame.pixels + std::int64_t(block.y) * this->frame.width + block.x, this->frame.width,
                    block.inside);
        return samples;
    }
};

}  // namespace chiaro::kernel

// What a ray finds of one value in one of the blocks that its volume is cut into.
#pragma once
#include "illumination/none/field.h"
#include "raycast/kernel.h"

namespace chiaro::kernel {

/// The ray caster's kernel that fills pixels with a block's part of a ray's value, for others to join
/// (raycast/shared_values.h): the largest or smallest stored value, or the sum of all, as many as there are steps, 0,
/// and 1; or four times 0 where the ray takes no sample in the block. One ray a pixel; all samples are taken.
template <class Voxel>
struct ValueKernel : RaycastKernel<Voxel, NoneView> {
    Rgba opaque{0, 0, 0, 1};

    template <class F>
    CHIARO_INLINE Int<F> operator()(const PixelBlock<F>& block) const {
        const SubPixel offset = sub_pixel(0, 1);
        const auto ray = this->camera.ray(to_float(block.column) + F(offset.x), to_float(block.row) + F(offset.y));
        Interval<F> hit = this->hit(block, ray);
        clip(this->clip_view, ray, hit);
        const Lattice<F> lattice = this->of_own_block(ray, hit.near, make_lattice(ray, hit, this->step_mm));
        Mask<F> alive = block.inside & (lattice.end > F(0)) & (lattice.first < lattice.end);
        const Mask<F> seen = alive;
        const bool sums = this->mode == March::mean;
        const F sign(this->extreme.sign);
        F k = lattice.first, found(sums ? 0 : -3e38f), steps(0);
        Int<F> samples(0);
        while (any(alive)) {
            const F value = this->matter.value_at(this->matter.volume.clamp(lattice.position(k)));
            const F share = select(alive, select(k < lattice.full, F(1), lattice.rest), F(0));
            found = sums ? mad(share, value, found) : select(alive, max(found, sign * value), found);
            steps = steps + share;
            samples += select(alive, Int<F>(1), Int<F>(0));
            k = k + F(1);
            alive &= k < lattice.end;
        }
        const Vec3<F> none{F(0), F(0), F(0)}, told{sums ? found : sign * found, steps, F(0)};
        RgbaLanes<F> pixel;
        zero(pixel);
        pixel = accumulate(pixel, select(seen, F(1), F(0)), light_up(load_rgba(&opaque, Int<F>(0)), none, told));
        store_block(pixel, this->frame.pixels + std::int64_t(block.y) * this->frame.width + block.x, this->frame.width,
                    block.inside);
        return samples;
    }
};

}  // namespace chiaro::kernel

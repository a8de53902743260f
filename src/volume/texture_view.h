// The volume as a GPU's texture units read it.
#pragma once
#include "volume/view.h"

namespace chiaro::kernel {

/// In the place of a stored type: any, in a texture.
struct Texel {};

/// What a texture unit says at a point, texel centres lying ½ beyond whole numbers. GPUs alone have it
/// (cuda/launch.h).
CHIARO_INLINE float texel_at(std::uint64_t texture, float x, float y, float z);

template <class F>
struct TexelLocation {
    Vec3<F> p, t;
};

/// A sample is one look-up, a gradient six, all with weights of 8 fractional bits; otherwise as the voxels are.
template <>
struct VolumeView<Texel> : GridOfVolume {
    std::uint64_t texture;
    float scale;  ///< stored units of what a look-up gives

    template <class F>
    CHIARO_INLINE TexelLocation<F> locate(Vec3<F> p, VoxelIndex<F> i) const {
        return {p, {p.x - to_float(i.x), p.y - to_float(i.y), p.z - to_float(i.z)}};
    }

    template <class F>
    CHIARO_INLINE F value(const TexelLocation<F>& at) const {
        return beside(at.p, 0, 0, 0);
    }
    template <class F>
    CHIARO_INLINE Four<Two<F>> corners(const TexelLocation<F>& at) const {
        const Vec3<F> first = at.p - at.t;
        const auto pair = [&](float y, float z) { return Two<F>{beside(first, 0, y, z), beside(first, 1, y, z)}; };
        return {pair(0, 0), pair(1, 0), pair(0, 1), pair(1, 1)};
    }
    template <class F>
    CHIARO_INLINE Vec3<F> gradient(const TexelLocation<F>& at) const {
        return {F(0.5f) * (beside(at.p, 1, 0, 0) - beside(at.p, -1, 0, 0)),
                F(0.5f) * (beside(at.p, 0, 1, 0) - beside(at.p, 0, -1, 0)),
                F(0.5f) * (beside(at.p, 0, 0, 1) - beside(at.p, 0, 0, -1))};
    }

private:
    template <class F>
    CHIARO_INLINE F beside(Vec3<F> p, float x, float y, float z) const {
        return F(scale) * texel_at(texture, p.x + (x + 0.5f), p.y + (y + 0.5f), p.z + (z + 0.5f));
    }
};

}  // namespace chiaro::kernel

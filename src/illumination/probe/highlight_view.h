// Highlights of a probe, as the ray caster looks them up.
#pragma once
#include "illumination/probe/octahedron.h"
#include "illumination/probe/reflection_table.h"
#include "kernel/gather.h"

namespace chiaro::kernel {

/// A surface shows ρ(n·v) times the mean radiance within its lobe, which is looked up by the mirrored eye r: exact for
/// an eye in the camera's axis, near to it for others.
struct HighlightView {
    const float (*radiance)[4] = nullptr;  ///< over an unfolded octahedron, in the probe's axes, u fastest; none: matte
    const float* reflected = nullptr;      ///< ρ at μ = 0, 1/steps ... 1
    std::int32_t edge = 0;                 ///< nodes a side
    float gain = 1;                        ///< exposure
    Float3 probe_x{}, probe_y{}, probe_z{};  ///< axes of the probe in the world
    Float3 eye{};                            ///< voxels; without perspective far away
    Float3 world_x{}, world_y{}, world_z{};  ///< rows of the matrix from vectors in voxels to the world

    template <class F>
    struct Place {
        OctahedronCell<F> cell;
        F reflected;  ///< ρ
    };
    /// By a unit normal of the world, on the side of the eye.
    template <class F>
    CHIARO_INLINE Place<F> locate(Vec3<F> p_voxel, Vec3<F> normal) const {
        const Vec3<F> away = Vec3<F>(eye) - p_voxel;
        const Vec3<F> far{dot(Vec3<F>(world_x), away), dot(Vec3<F>(world_y), away), dot(Vec3<F>(world_z), away)};
        const Vec3<F> to_eye = F(1) / sqrt(max(dot(far, far), F(1e-20f))) * far;
        const F cosine = dot(normal, to_eye);
        const Vec3<F> mirrored = (cosine + cosine) * normal - to_eye;
        const Vec3<F> of_probe{dot(Vec3<F>(probe_x), mirrored), dot(Vec3<F>(probe_y), mirrored),
                               dot(Vec3<F>(probe_z), mirrored)};
        const F step = min(max(cosine, F(0)), F(1)) * F(float(ReflectionTable::steps));
        const Int<F> i = min(truncate(step), Int<F>(ReflectionTable::steps - 1));
        return {octahedral_cell(of_probe, edge),
                lerp(gather_float(reflected, i), gather_float(reflected + 1, i), step - to_float(i))};
    }

    /// Mean radiance of three channels, between four entries.
    CHIARO_INLINE void add_to(float* sums, std::int32_t entry, const float (&weights)[4]) const {
        const std::int32_t around[4] = {entry, entry + 1, entry + edge, entry + edge + 1};
        for (int corner = 0; corner < 4; ++corner)
            for (int k = 0; k < 3; ++k) sums[k] = mad(gain * weights[corner], radiance[around[corner]][k], sums[k]);
    }
};

}  // namespace chiaro::kernel

// How much of a node is a surface (surface_share.h): one item a node.
#pragma once
#include "classify/surface_view.h"

namespace chiaro::kernel {

template <class Voxel>
struct SurfaceShareKernel {
    VolumeView<Voxel> volume;
    SurfaceView surface;
    float voxels_per_cell[3], step[3];  ///< from point to point, voxels
    std::int32_t points;                ///< per axis
    std::int32_t count[3];
    const float* density;
    float* share;

    CHIARO_INLINE void operator()(std::int64_t node, std::int32_t x, std::int32_t y, std::int32_t z) const {
        share[node] = may_show(x, y, z) ? largest(x, y, z) : 0;
    }

private:
    CHIARO_INLINE float depth(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const bool inside = x >= 0 && y >= 0 && z >= 0 && x < count[0] && y < count[1] && z < count[2];
        return inside ? density[(std::int64_t(z) * count[1] + y) * count[0] + x] : 0;
    }
    /// Where nothing changes there is no surface. (Of a film that is thinner still nothing is asked.)
    CHIARO_INLINE bool may_show(std::int32_t x, std::int32_t y, std::int32_t z) const {
        constexpr float thinnest = 0.02f;
        float least = depth(x, y, z), most = least;
        for (std::int32_t axis = 0; axis < 3; ++axis)
            for (std::int32_t side = -1; side <= 1; side += 2) {
                const float beside = depth(x + (axis == 0) * side, y + (axis == 1) * side, z + (axis == 2) * side);
                least = min(least, beside), most = max(most, beside);
            }
        return most - least > thinnest;
    }
    CHIARO_INLINE float along(int axis, std::int32_t node, std::int32_t point) const {
        return (float(node) + 0.5f) * voxels_per_cell[axis] - 0.5f +
               (float(point) - 0.5f * float(points - 1)) * step[axis];
    }
    CHIARO_INLINE float largest(std::int32_t x, std::int32_t y, std::int32_t z) const {
        float most = 0;
        for (std::int32_t k = 0; k < points; ++k)
            for (std::int32_t j = 0; j < points; ++j)
                for (std::int32_t i = 0; i < points; ++i) {
                    const Vec3<float> p{along(0, x, i), along(1, y, j), along(2, z, k)};
                    most = max(most, surface.at(volume, volume.clamp(p)).share);
                    if (most >= 1) return most;
                }
        return most;
    }
};

}  // namespace chiaro::kernel

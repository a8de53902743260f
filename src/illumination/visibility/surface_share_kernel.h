// How much of a node is a surface (surface_share.h): one item a node, whose points are taken sixteen at a time (F =
// Lanes) or one by one.
#pragma once
#include "classify/surface_view.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// The points that are asked for in each node.
struct SharePoints {
    static constexpr std::int32_t most_per_axis = 4, most = most_per_axis * most_per_axis * most_per_axis, width = 16;
    std::int32_t count, unused;
    float offset[3][most];  ///< [axis]: from the node's centre, voxels; what fills the last sixteen is the last point

    /// `per_axis` on each, `step` apart.
    SharePoints(std::int32_t per_axis, const float (&step)[3]) : count(per_axis * per_axis * per_axis), unused(0) {
        for (std::int32_t i = 0; i < most; ++i) {
            const std::int32_t point = i < count ? i : count - 1;
            const std::int32_t along[3]{point % per_axis, point / per_axis % per_axis, point / per_axis / per_axis};
            for (std::int32_t axis = 0; axis < 3; ++axis)
                offset[axis][i] = (float(along[axis]) - 0.5f * float(per_axis - 1)) * step[axis];
        }
    }
};

template <class Voxel>
struct SurfaceShareKernel {
    VolumeView<Voxel> volume;
    SurfaceView surface;
    float voxels_per_cell[3];
    std::int32_t count[3];
    const float* density;
    float* share;
    SharePoints points;

    CHIARO_INLINE void operator()(std::int64_t node, std::int32_t x, std::int32_t y, std::int32_t z) const {
        share[node] = may_show(x, y, z) ? largest<float>(x, y, z) : 0;
    }
    template <class F>
    CHIARO_INLINE void row(std::int32_t y, std::int32_t z) const {
        float* const to = share + (std::int64_t(z) * count[1] + y) * count[0];
        for (std::int32_t x = 0; x < count[0]; ++x) to[x] = may_show(x, y, z) ? largest<F>(x, y, z) : 0;
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
    CHIARO_INLINE float centre(int axis, std::int32_t node) const {
        return (float(node) + 0.5f) * voxels_per_cell[axis] - 0.5f;
    }
    template <class F>
    CHIARO_INLINE float largest(std::int32_t x, std::int32_t y, std::int32_t z) const {
        float most = 0;
        for (std::int32_t i = 0; i < points.count && most < 1; i += LaneTraits<F>::count) {
            const Vec3<F> p{F(centre(0, x)) + load_row<F>(points.offset[0] + i),
                            F(centre(1, y)) + load_row<F>(points.offset[1] + i),
                            F(centre(2, z)) + load_row<F>(points.offset[2] + i)};
            float shares[LaneTraits<F>::count];
            store_row(shares, surface.at(volume, volume.clamp(p)).share);
            for (const float share_there : shares) most = max(most, share_there);
        }
        return most;
    }
};

}  // namespace chiaro::kernel

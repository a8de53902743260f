// A directional sweep on a sheared lattice: each lattice point follows one straight ray through all planes, so nothing
// is blurred on the way; the field's nodes are interpolated between four rays. The item is sixteen nodes along a row
// (F = Lanes) or one, and one direction.
#pragma once
#include "illumination/visibility/project.h"
#include "kernel/math.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// A direction in one plane: lattice point (i, j) lies at (i + a, j + b), a and b in [0, 1).
struct ShearedDirection {
    float a, b;
    std::int32_t shift;  ///< of the same ray in the plane before, in lattice points
    float whole, outer;  ///< node edges × -log2 e: a step, and from the own cell's border to where V starts
};

/// Lattice points (i, j) of the planes from (-2, -2) to one beyond the last node; where no ray was before, all light
/// arrives. Densities have a halo of one node that holds none.
struct ShearedPlanes {
    const float* density;  ///< of node (0, 0)
    std::int32_t density_row;
    const float* light_before;  ///< [direction] of point (0, 0): behind the plane before
    float* light;               ///< behind this plane
    std::int32_t row;
    std::int64_t direction;  ///< from one direction's plane to the next one's
};

struct ShearedRow {
    std::int32_t j, count;  ///< lattice row, from -1 on; nodes
    float* field;           ///< of node (0, j); nullptr in row -1
    std::int64_t field_stride;
    float* scratch;  ///< [direction][width]
};

struct ShearedKernel {
    static constexpr std::int32_t width = 16;
    const ShearedDirection* directions;
    Harmonics harmonics;
    ShearedPlanes planes;

    template <class F>
    CHIARO_INLINE void operator()(const ShearedRow& row) const {
        Projection projection{harmonics};
        for (std::int32_t first = -1; first < row.count; first += width)
            for (std::int32_t d = 0; d < harmonics.directions; ++d)
                for (std::int32_t lane = 0; lane < width && first + lane < row.count; lane += LaneTraits<F>::count)
                    follow<F>(directions[d], d, first + lane, row.j);
        for (std::int32_t d = 0; d < harmonics.directions; ++d) planes.light[at(d, row.count, row.j)] = 1;
        if (!row.field) return;
        for (std::int32_t first = 0; first < row.count; first += width) {
            for (std::int32_t d = 0; d < harmonics.directions; ++d)
                for (std::int32_t lane = 0; lane < width && first + lane < row.count; lane += LaneTraits<F>::count)
                    store_row(row.scratch + d * width + lane, visible<F>(directions[d], d, first + lane, row.j));
            for (std::int32_t n = 0; n < width && first + n < row.count; ++n)
                projection.template add<F>(row.scratch + n, width, row.field + (first + n) * row.field_stride);
            projection.template flush<F>();
        }
    }

    /// For many threads: the ray of direction d through point (i, j), and what arrives there if that is a node.
    CHIARO_INLINE void point(std::int32_t d, std::int32_t i, std::int32_t j, float* seen) const {
        follow<float>(directions[d], d, i, j);
        if (i >= 0 && j >= 0) *seen = visible<float>(directions[d], d, i, j);
    }

private:
    CHIARO_INLINE std::int64_t at(std::int32_t d, std::int32_t i, std::int32_t j) const {
        return d * planes.direction + std::int64_t(j) * planes.row + i;
    }
    /// Of the four points from p on; s and t the shares of the second ones.
    template <class F>
    static CHIARO_INLINE F bilinear(const float* p, std::int32_t row, float s, float t) {
        const F low = lerp(load_row<F>(p), load_row<F>(p + 1), F(s));
        return lerp(low, lerp(load_row<F>(p + row), load_row<F>(p + row + 1), F(s)), F(t));
    }

    /// T = T' exp(-ℓ κ), κ interpolated where the ray meets the plane.
    template <class F>
    CHIARO_INLINE void follow(const ShearedDirection& ray, std::int32_t d, std::int32_t i, std::int32_t j) const {
        const F before = load_row<F>(planes.light_before + at(d, i, j) + ray.shift);
        const F density =
            bilinear<F>(planes.density + std::int64_t(j) * planes.density_row + i, planes.density_row, ray.a, ray.b);
        store_row(planes.light + at(d, i, j), before * exp2_below_0(density * F(ray.whole)));
    }
    /// What arrives at a node: between the rays at i - 1 + a and i + a.
    template <class F>
    CHIARO_INLINE F visible(const ShearedDirection& ray, std::int32_t d, std::int32_t i, std::int32_t j) const {
        const F arriving =
            bilinear<F>(planes.light_before + at(d, i - 1, j - 1) + ray.shift, planes.row, 1 - ray.a, 1 - ray.b);
        const F own = load_row<F>(planes.density + std::int64_t(j) * planes.density_row + i);
        return arriving * exp2_below_0(own * F(ray.outer));
    }
};

}  // namespace chiaro::kernel

// Towards the light, node by node, with steps that grow through the pyramid (Ritschel 2007, section 3): one node, or
// sixteen along x. How far the steps are apart does not depend on where they lead, so all lanes take the same.
#pragma once
#include "illumination/cells/place.h"
#include "illumination/sh/kernel.h"
#include "illumination/sh/scrambled.h"
#include "kernel/math.h"
#include "kernel/row.h"

namespace chiaro::kernel {

struct PyramidLevel {
    const std::uint16_t* values;  ///< expected transparency
    GridView grid;                ///< its "voxels" are the nodes that are walked from
    float scale;                  ///< 2^-level

    template <class F>
    CHIARO_INLINE F at(Vec3<F> p_node) const {
        return share_at(values, grid, p_node);
    }
};

/// One step of the walk; lengths in node edges.
struct WalkStep {
    float begin, size;   ///< distance from where the walk starts, and length
    std::int32_t level;  ///< the finer of the two that are read
    float coarser;       ///< share of the level above
};

/// Where sixteen lanes look.
struct LaneDirections {
    static constexpr std::int32_t width = 16;
    float x[width], y[width], z[width];
};

struct WalkKernel {
    const PyramidLevel* levels;
    const WalkStep* steps;
    std::int32_t step_count;
    Float3 count;  ///< nodes per axis
    float start;   ///< the walk begins on a cube of this half edge about the node

    static constexpr float dark = 1e-3f;  ///< less is not followed

    /// V(p, d) = Π T_l(midpoint)^(size / 2^l)
    template <class F>
    CHIARO_INLINE F transmittance(Vec3<F> p, Vec3<F> d) const {
        const F first = F(start) / max(max(abs(d.x), abs(d.y)), abs(d.z));
        const F exit = min(min(way_out(p.x, d.x, count.x), way_out(p.y, d.y, count.y)), way_out(p.z, d.z, count.z));
        F open(1);
        for (std::int32_t k = 0; k < step_count; ++k) {
            const WalkStep& step = steps[k];
            const F begin = first + F(step.begin), size = min(exit - begin, F(step.size));
            const auto goes_on = (size > F(0)) & (open >= F(dark));
            if (!any(goes_on)) break;
            open = select(goes_on, open * across(step, mad(mad(size, F(0.5f), begin), d, p), size), open);
        }
        return open;
    }

private:
    /// From a node to the border of the grid.
    template <class F>
    static CHIARO_INLINE F way_out(F p, F d, float nodes) {
        return select(d < F(0), p + F(0.5f), F(nodes - 0.5f) - p) / max(abs(d), F(1e-9f));
    }

    template <class F>
    CHIARO_INLINE F across(const WalkStep& step, Vec3<F> midpoint, F size) const {
        const F finer = to_length(levels[step.level].at(midpoint), size * F(levels[step.level].scale));
        if (step.coarser == 0) return finer;
        const PyramidLevel& above = levels[step.level + 1];
        return lerp(finer, to_length(above.at(midpoint), size * F(above.scale)), F(step.coarser));
    }
    /// T^length, in edges of its level
    template <class F>
    static CHIARO_INLINE F to_length(F transparency, F length) {
        const auto is_power = (transparency < F(1)) & (length != F(1));
        if (!any(is_power)) return transparency;
        return select(is_power, pow(transparency, max(length, F(0))), transparency);
    }
};

/// Σ V Y over directions look(i).
template <class F, class Look>
CHIARO_INLINE void walk_directions(const WalkKernel& kernel, Vec3<F> p, const Look& look, std::int32_t direction_count,
                                   std::int32_t coefficients, F* sum) {
    F y[16];
    for (std::int32_t c = 0; c < coefficients; ++c) sum[c] = F(0);
    for (std::int32_t i = 0; i < direction_count; ++i) {
        const Vec3<F> d = look(i);
        spherical_harmonics(d, coefficients, y);
        const F open = kernel.transmittance(p, d);
        for (std::int32_t c = 0; c < coefficients; ++c) sum[c] = mad(open, y[c], sum[c]);
    }
}

/// Σ V Y of sixteen nodes from x on, in `directions`: by coefficient, 4 or 16.
template <class F>
CHIARO_INLINE void walk_run(const WalkKernel& kernel, Float3 first_node, const LaneDirections* directions,
                            std::int32_t direction_count, std::int32_t coefficients,
                            float (*sums)[LaneDirections::width]) {
    float ahead[LaneDirections::width];
    for (std::int32_t i = 0; i < LaneDirections::width; ++i) ahead[i] = first_node.x + float(i);
    for (std::int32_t lane = 0; lane < LaneDirections::width; lane += LaneTraits<F>::count) {
        const Vec3<F> p{load_row<F>(ahead + lane), F(first_node.y), F(first_node.z)};
        const auto look = [&](std::int32_t i) CHIARO_INLINE_LAMBDA {
            return Vec3<F>{load_row<F>(directions[i].x + lane), load_row<F>(directions[i].y + lane),
                           load_row<F>(directions[i].z + lane)};
        };
        F sum[16];
        walk_directions(kernel, p, look, direction_count, coefficients, sum);
        for (std::int32_t c = 0; c < coefficients; ++c) store_row(sums[c] + lane, sum[c]);
    }
}

/// A thread for each node, which looks in the directions of a set of its own.
struct WalkNode {
    WalkKernel kernel;
    std::int32_t nx, ny;
    const Float3* directions;  ///< [set][direction]
    std::int32_t sets, direction_count, coefficients;
    float weight;  ///< of a direction
    float* field;  ///< [node][coefficient]
    std::int64_t first;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int64_t node = first + item;
        const Vec3<float> p{float(node % nx), float(node / nx % ny), float(node / nx / ny)};
        const std::uint64_t set = sets == 1 ? 0 : scrambled(std::uint64_t(node)) % std::uint64_t(sets);
        const Float3* own = directions + std::int64_t(set) * direction_count;
        const auto look = [&](std::int32_t i) CHIARO_INLINE_LAMBDA { return Vec3<float>(own[i]); };
        float sum[16];
        walk_directions(kernel, p, look, direction_count, coefficients, sum);
        for (std::int32_t c = 0; c < coefficients; ++c) field[node * coefficients + c] = sum[c] * weight;
    }
};

using WalkFunction = void (*)(const WalkKernel&, Float3, const LaneDirections*, std::int32_t, std::int32_t,
                              float (*)[LaneDirections::width]);

}  // namespace chiaro::kernel

// A directional sweep (docs/theory/visibility.md): planes perpendicular to the directions' major axis, from the light's
// side; each node takes the light of the point one plane back along the direction. The item is a node and sixteen
// directions (F = Lanes) or one (F = float).
#pragma once
#include "illumination/visibility/project.h"
#include "kernel/math.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Sixteen directions of one major axis and sign. Their points one plane back lie between a few nodes: the taps.
struct SweepPack {
    static constexpr std::int32_t width = 16, max_taps = 9;
    std::int32_t taps;
    std::int32_t offset[max_taps];        ///< of a tap from the node, in nodes of a plane with its halo
    const float* weights;                 ///< [tap][direction], bilinear
    const float *before, *outer, *inner;  ///< node edges × -log2 e: half a step before the plane, then to where V
                                          ///< starts, then to the node
};

/// One plane and the one before it; nodes with a halo of one, where nothing stops the light.
struct SweepPlanes {
    const float* density_before;
    float* density;
    const float* light_before;  ///< [node][direction]: what arrives at a node's centre
    float* light;
    const std::uint8_t* state_before;
    std::uint8_t* state;
    std::int32_t row;         ///< nodes from one row to the next
    std::int32_t directions;  ///< of a node, whole packs
};

/// What is known of a node, bit by bit: all the light arrives at its centre, or none, from all of the directions; it
/// stops none.
enum SweepState : std::uint8_t { clear = 1, dark = 2, empty = 4 };

struct SweepRow {
    std::int32_t first, count;  ///< first node, in the planes
    const float* density;       ///< of the grid, to be read into the plane
    std::int64_t density_stride;
    float* field;  ///< coefficients of the first node
    std::int64_t field_stride;
    float* scratch;  ///< project_together × directions
};

struct SweepKernel {
    const SweepPack* packs;
    Harmonics harmonics;
    SweepPlanes planes;

    template <class F>
    CHIARO_INLINE void operator()(const SweepRow& row) const {
        Projection projection{harmonics};
        for (std::int32_t i = 0; i < row.count; ++i) {
            const std::int32_t node = row.first + i;
            const float density = row.density[i * row.density_stride];
            const std::uint8_t around = state_around(node), own = density > 0 ? 0 : empty;
            float* field = row.field + i * row.field_stride;
            planes.density[node] = density;
            if (stays_clear(around, own)) {
                fill(node, 1);
                planes.state[node] = clear | own;
                harmonics.add_all(field);
            } else if (around & dark) {
                fill(node, 0);
                planes.state[node] = dark | own;
            } else {
                float* visibility = row.scratch + projection.count * planes.directions;
                const bool lit = take<F>(node, density, !(around & empty), visibility);
                planes.state[node] = lit ? own : dark | own;
                projection.template add<F>(visibility, 1, field);
            }
        }
        projection.template flush<F>();
    }

    /// For many threads: one direction's way to a node; `seen`: what arrives there, unless all light does. Returns
    /// whether any does. That no light is left is not noted, for it makes no difference.
    CHIARO_INLINE bool at(std::int32_t node, std::int32_t d, float density, float* seen) const {
        const std::uint8_t around = state_around(node), own = density > 0 ? 0 : empty;
        const bool is_clear = stays_clear(around, own);
        if (d == 0) planes.density[node] = density, planes.state[node] = is_clear ? clear | own : own;
        float* light = planes.light + std::int64_t(node) * planes.directions + d;
        if (is_clear) {
            *light = 1;
            return true;
        }
        const SweepPack& pack = packs[d / SweepPack::width];
        const std::int32_t lane = d % SweepPack::width;
        pass<float>(pack, lane, density, arriving<float>(pack, lane, d, node, !(around & empty)), seen, light);
        return *seen > 0;
    }
    /// Then: coefficient c of what all directions saw from the node.
    CHIARO_INLINE void project_at(std::int32_t node, std::int32_t c, const float* seen, float* field) const {
        if (planes.state[node] & clear)
            field[c] += harmonics.sum[c];
        else
            harmonics.template project_at<float, 1>(c, &seen, 1, &field);
    }

private:
    static CHIARO_INLINE bool stays_clear(std::uint8_t around, std::uint8_t own) {
        return own && (around & clear) && (around & empty);
    }
    /// What all the nodes that the directions' points lie between have in common.
    CHIARO_INLINE std::uint8_t state_around(std::int32_t node) const {
        std::uint8_t common = clear | dark | empty;
        for (std::int32_t v = -1; v <= 1; ++v) {
            const std::uint8_t* state = planes.state_before + node + v * planes.row;
            common &= state[-1] & state[0] & state[1];
        }
        return common;
    }
    CHIARO_INLINE void fill(std::int32_t node, float value) const {
        float* light = planes.light + std::int64_t(node) * planes.directions;
        for (std::int32_t d = 0; d < planes.directions; ++d) light[d] = value;
    }

    /// Moves the light of all directions to the node; returns whether any arrives.
    template <class F>
    CHIARO_INLINE bool take(std::int32_t node, float density, bool matter_before, float* visibility) const {
        bool lit = false;
        const std::int32_t packs_count = planes.directions / SweepPack::width;
        for (std::int32_t p = 0; p < packs_count; ++p)
            for (std::int32_t lane = 0; lane < SweepPack::width; lane += LaneTraits<F>::count) {
                const std::int32_t first = p * SweepPack::width + lane;
                const F visible = arriving<F>(packs[p], lane, first, node, matter_before);
                lit |= pass<F>(packs[p], lane, density, visible, visibility + first,
                               planes.light + std::int64_t(node) * planes.directions + first);
            }
        return lit;
    }

    template <class F>
    CHIARO_INLINE F arriving(const SweepPack& pack, std::int32_t lane, std::int32_t first, std::int32_t node,
                             bool matter_before) const {
        return pack.taps == 4 ? arriving_by<F, 4>(pack, lane, first, node, matter_before)
                              : arriving_by<F, 0>(pack, lane, first, node, matter_before);
    }
    /// Σ w T' exp(-½ℓ Σ w κ'), ' one plane back, w bilinear: what arrives at the own cell's border.
    template <class F, std::int32_t known_taps>
    CHIARO_INLINE F arriving_by(const SweepPack& pack, std::int32_t lane, std::int32_t first, std::int32_t node,
                                bool matter_before) const {
        const std::int32_t taps = known_taps ? known_taps : pack.taps;
        const float* weights = pack.weights + lane;
        F light(0), density(0);
        for (std::int32_t tap = 0; tap < taps; ++tap) {
            const std::int64_t from = std::int64_t(node) + pack.offset[tap];
            const F weight = load_row<F>(weights + tap * SweepPack::width);
            light = mad(weight, load_row<F>(planes.light_before + from * planes.directions + first), light);
            if (matter_before) density = mad(weight, F(planes.density_before[from]), density);
        }
        if (!matter_before) return light;
        return light * exp2_below_0(density * load_row<F>(pack.before + lane));
    }

    /// V = what arrives × exp(-outer κ), T = V exp(-inner κ); returns whether any light is left.
    template <class F>
    CHIARO_INLINE bool pass(const SweepPack& pack, std::int32_t lane, float density, F visible, float* visibility,
                            float* light) const {
        if (density > 0) visible = visible * exp2_below_0(F(density) * load_row<F>(pack.outer + lane));
        store_row(visibility, visible);
        if (density > 0) visible = visible * exp2_below_0(F(density) * load_row<F>(pack.inner + lane));
        visible = select(visible < F(no_light), F(0), visible);
        store_row(light, visible);
        return any(visible > F(0));
    }
    static constexpr float no_light = 1e-6f;
};

}  // namespace chiaro::kernel

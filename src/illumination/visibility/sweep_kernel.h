// A directional sweep (docs/theory/visibility.md): planes perpendicular to the directions' major axis, from the light's
// side; each node takes the light of the point one plane back along the direction. The item is a node and sixteen
// directions (F = Lanes) or one (F = float).
#pragma once
#include "illumination/visibility/project.h"
#include "kernel/math.h"
#include "kernel/prefetch.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Sixteen directions of one major axis and sign. Their points one plane back lie between a few nodes: the taps.
struct SweepPack {
    static constexpr std::int32_t width = 16, max_taps = 9;
    std::int8_t taps;
    bool is_even;                         ///< outer and inner are the same
    std::int8_t rows[max_taps];           ///< of a tap from the node
    std::int32_t offset[max_taps];        ///< the same in nodes of a plane with its halo
    const float* weights;                 ///< [tap][direction], bilinear
    const float *before, *outer, *inner;  ///< node edges × -log2 e: half a step before the plane, then to where V
                                          ///< starts, then to the node
};

/// One plane and the one before it; nodes with a halo of one, where nothing stops the light.
struct SweepPlanes {
    const float* density_before;
    float* density;
    const float* light_before;  ///< [row][pack][node][direction]: what arrives at a node's centre
    float* light;
    const std::uint8_t* state_before;
    std::uint8_t* state;
    std::int32_t row;    ///< nodes from one row to the next
    std::int32_t packs;  ///< of directions

    /// Numbers of light from a node's to a tap's.
    CHIARO_INLINE std::int32_t light_of_tap(const SweepPack& pack, std::int32_t tap) const {
        return SweepPack::width * (pack.offset[tap] + pack.rows[tap] * row * (packs - 1));
    }
    /// Where a pack's light of a node lies.
    CHIARO_INLINE std::int64_t light_at(std::int32_t node, std::int32_t pack) const {
        return std::int64_t(SweepPack::width) * (node + (std::int64_t(node / row) * (packs - 1) + pack) * row);
    }
};

/// What is known of a node, bit by bit: all the light arrives at its centre, or none, from all of the directions; it
/// stops none.
enum SweepState : std::uint8_t { clear = 1, dark = 2, empty = 4 };

/// Nodes of a row whose light is followed together.
inline constexpr std::int32_t sweep_together = 16;

struct SweepRow {
    std::int32_t first, count;  ///< first node, in the planes
    const float* density;       ///< of the grid, to be read into the plane
    std::int64_t density_stride;
    float* field;  ///< coefficients of the first node
    std::int64_t field_stride;
    float* scratch;  ///< sweep_together × directions
};

struct SweepKernel {
    const SweepPack* packs;
    Harmonics harmonics;
    SweepPlanes planes;

    /// A few nodes at a time: those that light must be followed to are sorted by what must be known of them, so that a
    /// pack's numbers stay in registers from node to node and nothing is asked on the way.
    template <class F>
    CHIARO_INLINE void operator()(const SweepRow& row) const {
        const SweepKernel here = *this;  // whose numbers no store can change: they stay in registers
        for (std::int32_t first = 0; first < row.count; first += sweep_together)
            here.template take<F>(row, first, min(sweep_together, row.count - first));
    }

    /// For many threads: one direction's way to a node; `seen`: what arrives there, unless all light does. Returns
    /// whether any does. That no light is left is not noted, for it makes no difference.
    CHIARO_INLINE bool at(std::int32_t node, std::int32_t d, float density, float* seen) const {
        const std::uint8_t around = state_around(node), own = density > 0 ? 0 : empty;
        const bool is_clear = stays_clear(around, own);
        if (d == 0) planes.density[node] = density, planes.state[node] = is_clear ? clear | own : own;
        const std::int32_t p = d / SweepPack::width, lane = d % SweepPack::width;
        const std::int64_t here = planes.light_at(node, p) + lane;
        if (is_clear) {
            planes.light[here] = 1;
            return true;
        }
        const Taps<float, 0> taps(packs[p], planes, lane);
        const bool matter = !(around & empty);
        pass(taps, density, matter ? arriving<true>(taps, node, here) : arriving<false>(taps, node, here), seen,
             planes.light + here);
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
        std::uint8_t common;
        states_around<1>(node, 1, &common);
        return common;
    }
    /// The same of a few nodes in a row.
    template <std::int32_t most>
    CHIARO_INLINE void states_around(std::int32_t node, std::int32_t count, std::uint8_t* around) const {
        std::uint8_t columns[most + 2];
        const std::uint8_t *above = planes.state_before + node - 1 - planes.row, *beside = above + planes.row,
                           *below = beside + planes.row;
        for (std::int32_t i = 0; i < count + 2; ++i) columns[i] = above[i] & beside[i] & below[i];
        for (std::int32_t i = 0; i < count; ++i) around[i] = columns[i] & columns[i + 1] & columns[i + 2];
    }
    CHIARO_INLINE void fill(std::int32_t node, float value) const {
        for (std::int32_t p = 0; p < planes.packs; ++p) {
            float* light = planes.light + planes.light_at(node, p);
            for (std::int32_t d = 0; d < SweepPack::width; ++d) light[d] = value;
        }
    }

    /// What must be known of a node besides the light around it, bit by bit.
    enum Kind : std::int32_t { matter_before = 1, matter_here = 2, kinds = 4 };
    struct NodeList {
        std::int32_t count = 0;
        std::int32_t node[sweep_together];
        float density[sweep_together];
        float *visibility[sweep_together], *field[sweep_together];
    };
    /// Moves the light to some nodes of the row, and adds what they see.
    template <class F>
    CHIARO_INLINE void take(const SweepRow& row, std::int32_t first, std::int32_t count) const {
        NodeList lists[kinds];
        if (sort(row, first, count, lists) == 0) return;
        for (std::int32_t p = 0; p < planes.packs; ++p)
            if (packs[p].taps == 4)
                follow_all<F, 4>(p, lists);
            else
                follow_all<F, 0>(p, lists);
        Projection projection{harmonics};
        for (const NodeList& list : lists)
            for (std::int32_t n = 0; n < list.count; ++n) {
                if (!is_lit<F>(list.node[n])) planes.state[list.node[n]] |= dark;
                projection.template add<F>(list.visibility[n], 1, list.field[n]);
            }
        projection.template flush<F>();
    }
    /// Finishes the nodes where all of the light arrives, or none, and puts the others into lists; returns how many.
    CHIARO_INLINE std::int32_t sort(const SweepRow& row, std::int32_t first, std::int32_t count,
                                    NodeList* lists) const {
        std::uint8_t around[sweep_together];
        states_around<sweep_together>(row.first + first, count, around);
        float* visibility = row.scratch;
        std::int32_t found = 0;
        for (std::int32_t i = first; i < first + count; ++i) {
            const std::int32_t node = row.first + i;
            const std::uint8_t common = around[i - first], before = planes.state[node];
            const float density = row.density[i * row.density_stride];
            const std::uint8_t own = density > 0 ? 0 : empty;
            float* field = row.field + i * row.field_stride;
            prefetch(field);  // added to once the light of all has moved
            planes.density[node] = density;
            if (stays_clear(common, own)) {
                if (!(before & clear)) fill(node, 1);
                planes.state[node] = clear | own;
                harmonics.add_all(field);
            } else if (common & dark) {
                if (!(before & dark)) fill(node, 0);
                planes.state[node] = dark | own;
            } else {
                NodeList& list = lists[(common & empty ? 0 : matter_before) | (own ? 0 : matter_here)];
                const std::int32_t n = list.count++;
                list.node[n] = node, list.density[n] = density, list.field[n] = field;
                list.visibility[n] = visibility;
                visibility += planes.packs * SweepPack::width;
                planes.state[node] = own;
                ++found;
            }
        }
        return found;
    }
    template <class F>
    CHIARO_INLINE bool is_lit(std::int32_t node) const {
        for (std::int32_t p = 0; p < planes.packs; ++p)
            for (std::int32_t lane = 0; lane < SweepPack::width; lane += LaneTraits<F>::count)
                if (any(F(0) < load_row<F>(planes.light + planes.light_at(node, p) + lane))) return true;
        return false;
    }

    /// A pack's numbers for some of its lanes.
    template <class F, std::int32_t known>
    struct Taps {
        static constexpr std::int32_t most = known ? known : SweepPack::max_taps;
        std::int32_t number, offset[most], light[most];
        bool is_even;
        F weights[most], before, outer, inner;

        CHIARO_INLINE Taps(const SweepPack& pack, const SweepPlanes& planes, std::int32_t lane)
            : number(pack.taps),
              is_even(pack.is_even),
              before(load_row<F>(pack.before + lane)),
              outer(load_row<F>(pack.outer + lane)),
              inner(load_row<F>(pack.inner + lane)) {
            for (std::int32_t tap = 0; tap < count(); ++tap) {
                offset[tap] = pack.offset[tap], light[tap] = planes.light_of_tap(pack, tap);
                weights[tap] = load_row<F>(pack.weights + tap * SweepPack::width + lane);
            }
        }
        CHIARO_INLINE std::int32_t count() const { return known ? known : number; }
    };

    template <class F, std::int32_t known_taps>
    CHIARO_INLINE void follow_all(std::int32_t p, const NodeList* lists) const {
        for (std::int32_t lane = 0; lane < SweepPack::width; lane += LaneTraits<F>::count) {
            const Taps<F, known_taps> taps(packs[p], planes, lane);
            follow<0>(taps, p, lane, lists[0]);
            follow<matter_before>(taps, p, lane, lists[matter_before]);
            follow<matter_here>(taps, p, lane, lists[matter_here]);
            follow<matter_before | matter_here>(taps, p, lane, lists[matter_before | matter_here]);
        }
    }
    /// Moves the light of a pack's directions to nodes.
    template <std::int32_t kind, class F, std::int32_t known_taps>
    CHIARO_INLINE void follow(const Taps<F, known_taps>& taps, std::int32_t p, std::int32_t lane,
                              const NodeList& list) const {
        if (list.count == 0) return;
        const std::int64_t first =
            planes.light_at(list.node[0], p) - list.node[0] * std::int64_t(SweepPack::width) + lane;
        for (std::int32_t n = 0; n < list.count; ++n) {
            const std::int32_t node = list.node[n];
            const std::int64_t here = first + node * std::int64_t(SweepPack::width);
            const F visible = arriving<(kind & matter_before) != 0>(taps, node, here);
            pass(taps, kind & matter_here ? list.density[n] : 0, visible,
                 list.visibility[n] + p * SweepPack::width + lane, planes.light + here);
        }
    }

    /// Σ w T' exp(-½ℓ Σ w κ'), ' one plane back, w bilinear: what arrives at the own cell's border.
    template <bool matter, class F, std::int32_t known_taps>
    CHIARO_INLINE F arriving(const Taps<F, known_taps>& taps, std::int32_t node, std::int64_t here) const {
        F light(0), density(0);
        for (std::int32_t tap = 0; tap < taps.count(); ++tap) {
            light = mad(taps.weights[tap], load_row<F>(planes.light_before + here + taps.light[tap]), light);
            if (matter) density = mad(taps.weights[tap], F(planes.density_before[node + taps.offset[tap]]), density);
        }
        if (!matter) return light;
        return light * exp2_below_0(density * taps.before);
    }

    /// V = what arrives × exp(-outer κ), T = V exp(-inner κ).
    template <class F, std::int32_t known_taps>
    CHIARO_INLINE void pass(const Taps<F, known_taps>& taps, float density, F visible, float* visibility,
                            float* light) const {
        F half(1);
        if (density > 0) visible = visible * (half = exp2_below_0(F(density) * taps.outer));
        store_row(visibility, visible);
        if (density > 0) visible = visible * (taps.is_even ? half : exp2_below_0(F(density) * taps.inner));
        store_row(light, zero_below(visible, F(no_light), visible));
    }
    static constexpr float no_light = 1e-6f;
};

}  // namespace chiaro::kernel

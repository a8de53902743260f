// Scattered light as the ray caster reads it: J between the nodes, and what of it falls on surfaces.
#pragma once
#include "illumination/cells/node_light.h"
#include "illumination/cut_light.h"
#include "illumination/view.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Scattered light around a node: numbers[i] × step is, times `open`, J of three channels, then its first moment along
/// x, y and z; every fourth is none's.
struct AroundNode {
    std::int8_t numbers[16];
    float step;
    float open;  ///< what the node lets through: what it weighs beside others
};

/// Beside NodeLight, whose nodes hold J w and w, the weight that a node has between others (docs/theory/transport.md):
/// J = Σ t_i w_i J_i / Σ t_i w_i.
struct ScatteredLight {
    bool on = false;
    const AroundNode* around = nullptr;       ///< [node]: where matter has surfaces
    const Light16* boundary_cells = nullptr;  ///< [node][4]: as the light, where particles are solid by themselves;
                                              ///< nullptr: as elsewhere
    float lift_edges = 0;                     ///< on surfaces light is read so far off
    float hidden_lift_edges = 0;              ///< ... that see a tenth less than a free one does
    float shown = 1;                          ///< strength and exposure
    Float3 clear{0, 0, 0};                    ///< added: what strength leaves of light that nothing stops

    /// On particles.
    template <class F>
    CHIARO_INLINE Vec3<F> incident(const NodeLight& light, const SamplePoint<F>& sample) const {
        const auto place = light.locate(sample.p_voxel);
        Vec3<F> e = mean(light, light.four(light.nodes, place));
        if (boundary_cells && any(sample.solid > F(0)))
            e = mad(sample.solid, mean(light, light.four(boundary_cells, place)) - e, e);
        return mad(F(shown), e, Vec3<F>(clear));
    }

    /// How far a surface that sees this share of even light is from seeing half of it, as all that are free do: 0 to 1.
    static CHIARO_INLINE float hidden(float seen) { return min(max(10 * (0.5f - seen), 0.0f), 1.0f); }

    /// Added to E of a surface, between eight nodes: what comes from above its horizon, whose cosine is `horizon` (-1
    /// to 0), if light is alike on either side of that: J + 2 m · n / (1 - horizon).
    template <class Sixteen>
    CHIARO_INLINE void add_to(float* e, const std::int64_t (&of)[8], const float (&weights)[8],
                              const float (&normal)[3], float horizon) const {
        Sixteen sums(0.0f);
        float open = 0;
        for (int i = 0; i < 8; ++i) {
            const AroundNode& node = around[of[i]];
            sums = sums + Sixteen(weights[i] * node.step) * loaded<Sixteen>(node.numbers);
            open = mad(weights[i], node.open, open);
        }
        float found[16];
        store(sums, found);
        const float per_open = shown / max(open, 1e-6f), turned = 2 / (1 - horizon);
        for (int c = 0; c < 3; ++c) {
            const float moment = normal[0] * found[4 + c] + normal[1] * found[8 + c] + normal[2] * found[12 + c];
            e[c] = mad(max(mad(turned, moment, found[c]), 0.0f), per_open, e[c]);
        }
    }

private:
    /// Σ t w J / Σ t w of what was looked up.
    template <class F>
    static CHIARO_INLINE Vec3<F> mean(const NodeLight& light, const Four<F>& sums) {
        const F inverse = F(1) / max(sums.d, F(1e-20f));
        return {sums.a * inverse * F(light.scale.x), sums.b * inverse * F(light.scale.y),
                sums.c * inverse * F(light.scale.z)};
    }
};

}  // namespace chiaro::kernel

// Scattered light as the ray caster reads it: J between the nodes, on surfaces by Lambert's law from its first moment.
#pragma once
#include "illumination/cells/node_light.h"
#include "illumination/cut_light.h"
#include "illumination/view.h"

namespace chiaro::kernel {

/// Beside NodeLight, whose nodes hold J w and w, the weight that a node has between others (docs/theory/transport.md):
///
///     J = Σ t_i w_i J_i / Σ t_i w_i,      E = J (1 + |b · n|),      b = 2 q M / J
///
/// M is the first moment of the light around, q the share of the node that is a surface with a normal n: light of two
/// colours from the half spaces above and below it gives E = J + 2 M · n exactly.
struct ScatteredLight {
    static constexpr float most = 2;  ///< of a component of b

    bool on = false;
    const Light16* turned =
        nullptr;  ///< [node][4]: (b / most + 1) w / 2, world; nullptr: no light by the sample's normal
    const Light16* boundary_cells =
        nullptr;            ///< [node][4]: as the light, where matter is solid by itself; nullptr: as elsewhere
    float shown = 1;        ///< strength and exposure
    Float3 clear{0, 0, 0};  ///< added: what strength leaves of light that nothing stops
    float share = 0;        ///< of the light that highlights may show

    template <class F>
    CHIARO_INLINE Incident<F> incident(const NodeLight& light, const CutLight& cut_light, const SamplePoint<F>& sample,
                                       const ShadingView& shading) const {
        const auto place = light.locate(sample.p_voxel);
        const Four<F> j = light.four(light.nodes, place);
        const F inverse = per_weight(j);
        Vec3<F> e = mean(light, j, inverse);
        F shining(0);
        if (turned) {
            const Four<F> t = light.four(turned, place);
            const F scale = F(2 * most) * inverse;
            const Vec3<F> b{mad(t.a, scale, F(-most)), mad(t.b, scale, F(-most)), mad(t.c, scale, F(-most))};
            shining = min(max(F(0.5f) * dot(b, Vec3<F>(shading.to_light)), F(0)), F(share)) * sample.highlight;
            e = (F(1) + abs(dot(b, sample.outward))) * e;
        }
        if (boundary_cells && any(sample.solid > F(0))) {
            const Four<F> s = light.four(boundary_cells, place);
            e = mad(sample.solid, mean(light, s, per_weight(s)) - e, e);
        }
        e = mad(F(shown), e, Vec3<F>(clear));
        cut_light.shine_on(sample.cut, e);
        return {e, Vec3<F>(shining * e.x * F(shading.specular.x), shining * e.y * F(shading.specular.y),
                           shining * e.z * F(shading.specular.z))};
    }

private:
    template <class F>
    static CHIARO_INLINE F per_weight(const Four<F>& sums) {
        return F(1) / max(sums.d, F(1e-20f));
    }
    /// Σ t w J / Σ t w of what was looked up.
    template <class F>
    static CHIARO_INLINE Vec3<F> mean(const NodeLight& light, const Four<F>& sums, F inverse) {
        return {sums.a * inverse * F(light.scale.x), sums.b * inverse * F(light.scale.y),
                sums.c * inverse * F(light.scale.z)};
    }
};

}  // namespace chiaro::kernel

// Where a medium has a surface: the model of docs/theory/light.md.
#pragma once
#include "volume/view.h"

namespace chiaro::kernel {

template <class F>
struct SurfaceAt {
    F value;           ///< stored units
    Vec3<F> gradient;  ///< of the value, stored units per voxel
    Vec3<F> outward;   ///< n, unit, world: towards where opacity falls; 0 where values are even
    F share;           ///< q, [0, 1]: of the matter here that scatters as a surface
    F hold;            ///< h, [0, 1]: of light that leaves here, what half an edge does not dim
    F factor;          ///< what opacity by gradient leaves of extinction
    F depth;           ///< [0, 2]: edges of matter like this between here and the outside
};

/// How much of a surface matter is and how deep in it, by value and slope, where opacity is the optical table's alone.
/// Bilinear; by the bytes of the nodes (v, s), (v + 1, s), (v, s + 1) and (v + 1, s + 1) in a word.
struct ShareTableView {
    const std::uint32_t* shares = nullptr;  ///< [octave of the slope's square][value]; null: there is no table
    const std::uint32_t* depths = nullptr;
    float scale, offset;    ///< (stored - middle) / half the optical table's width = stored * scale + offset
    float slope_scale = 0;  ///< from the square of a slope, stored units per smallest edge, to one of that half

    /// Nodes of values are even within the optical table, `per_octave` for either half, and as many for each octave of
    /// the distance from its middle beyond; two nodes for each octave of slope.
    static constexpr int per_octave = 128, octaves_beyond = 4, middle = per_octave * (1 + octaves_beyond),
                         values = 2 * middle + 1, octaves = 32, least_octave = -20;
    static constexpr float farthest = 1 << octaves_beyond, deepest = 2;

    template <class F>
    struct Place {
        typename GatherIndex<F>::type quad;
        F t, u;
    };

    template <class F>
    CHIARO_INLINE Place<F> locate(F stored, F slope_squared) const {
        F slope = slope_squared * F(slope_scale);
        const F way = mad(stored, F(scale), F(offset));
        F far = abs(way);
        // From farther away all that the optical table changes in is a step, which a steeper slope has there.
        if (any(far > F(farthest))) {
            const F nearer = F(farthest) / max(far, F(farthest));
            slope = slope * nearer * nearer;
            far = min(far, F(farthest));
        }
        const F off = F(per_octave) * select(far < F(1), far, F(1) + octave_of(far));
        const F v = min(F(middle) + select(way < F(0), F(0) - off, off), F(values - 1 - 1e-3f));
        const F s = min(max(octave_of(slope) - F(least_octave), F(0)), F(octaves - 1e-3f));
        const Int<F> i = truncate(v), j = truncate(s), quad = j * Int<F>(values) + i;
        return {typename GatherIndex<F>::type(quad), v - to_float(i), s - to_float(j)};
    }
    template <class F>
    CHIARO_INLINE F share(const Place<F>& at) const {
        return F(1.0f / 255) * interpolate(shares, at);
    }
    template <class F>
    CHIARO_INLINE F depth(const Place<F>& at) const {
        return F(deepest / 255) * interpolate(depths, at);
    }

    /// Of x > 0, even within each: a float's bits go up by 2^23 an octave, and within it as the number does.
    template <class F>
    static CHIARO_INLINE F octave_of(F x) {
        return mad(to_float(bits_of(x)), F(1.0f / (1 << 23)), F(-127));
    }

private:
    template <class F>
    static CHIARO_INLINE F interpolate(const std::uint32_t* quads, const Place<F>& at) {
        const Int<F> quad = gather_word(quads, at.quad);
        const auto byte = [&](int n) CHIARO_INLINE_LAMBDA { return to_float((quad >> Int<F>(8 * n)) & Int<F>(255)); };
        return lerp(lerp(byte(0), byte(1), at.t), lerp(byte(2), byte(3), at.t), at.u);
    }
};

struct SurfaceView {
    const float* opacity;       ///< α of a voxel's smallest edge, over the optical table
    float scale, offset, last;  ///< entry = stored * scale + offset
    float edge_mm;
    Float3 world_x, world_y, world_z;  ///< rows of the matrix from a gradient per voxel to one per edge, in the world

    /// Tuned on balls with edges of .4 to 3 voxels (tests/surfaces_test.cpp): with 4 the softest is 39 % too dark.
    static constexpr float gain = 8;
    static constexpr float another = 0.02f;  ///< a rise of opacity within an edge that tells another surface

    template <class F>
    CHIARO_INLINE F opacity_of(F stored) const {
        return gather_float(opacity, truncate(min(max(mad(stored, F(scale), F(offset)), F(0)), F(last))));
    }

    template <class F>
    CHIARO_INLINE Vec3<F> to_world(Vec3<F> gradient) const {
        return {dot(Vec3<F>(world_x), gradient), dot(Vec3<F>(world_y), gradient), dot(Vec3<F>(world_z), gradient)};
    }

    /// Of a clamped point. Opacity within an edge or two is read from the table, for values that go on as the gradient
    /// has them.
    template <class F, class Voxel>
    CHIARO_INLINE SurfaceAt<F> at(const VolumeView<Voxel>& volume, Vec3<F> p) const {
        const auto where = volume.locate(p, volume.voxel(p));
        return of(volume, where, volume.value(where), volume.gradient(where));
    }

    /// Of a value and its gradient, stored units per voxel; of mixtures the gradient of extinction.
    template <class F, class Volume, class Place>
    CHIARO_INLINE SurfaceAt<F> of(const Volume& volume, const Place& where, F value, Vec3<F> gradient) const {
        SurfaceAt<F> s;
        s.value = value;
        s.gradient = gradient;
        const bool by_gradient = volume.has_factor();
        s.factor = by_gradient ? volume.factor_of(value, gradient) : F(1);
        const Vec3<F> g = to_world(s.gradient);
        const F slope = sqrt(dot(g, g));
        if (volume.is_mixed()) {
            FiveExtinctions<F> five;
            volume.extinction_along(where, (F(1) / max(slope, F(1e-12f))) * from_world(g), five);
            for (F& kappa : five.at) kappa = opacity_of_edge(kappa);
            tell(g, slope, five.at, s);
            return s;
        }
        const auto opacity_at = [&](float edges) CHIARO_INLINE_LAMBDA {
            const F alpha = opacity_of(mad(F(edges), slope, s.value));
            return by_gradient ? opacity_of_share(alpha, s.factor) : alpha;
        };
        const F opacities[5]{opacity_at(-1.5f), opacity_at(-0.5f), opacity_at(0), opacity_at(0.5f), opacity_at(1.5f)};
        tell(g, slope, opacities, s);
        return s;
    }
    /// The square of a gradient's slope, stored units per smallest edge.
    template <class F>
    CHIARO_INLINE F slope_squared(Vec3<F> gradient) const {
        const Vec3<F> g = to_world(gradient);
        return dot(g, g);
    }
    /// Of a value whose opacity is the optical table's, and of a slope, stored units per smallest edge.
    SurfaceAt<float> of_slope(float stored, float slope) const {
        const auto opacity_at = [&](float edges) { return opacity_of(stored + edges * slope); };
        const float opacities[5]{opacity_at(-1.5f), opacity_at(-0.5f), opacity_at(0), opacity_at(0.5f),
                                 opacity_at(1.5f)};
        SurfaceAt<float> s;
        tell<float>({slope, 0, 0}, slope, opacities, s);
        return s;
    }

    /// Whether opacity rises along a direction (voxels per mm), so that another surface begins.
    template <class F, class Volume>
    CHIARO_INLINE Mask<F> rises(const Volume& volume, const SurfaceAt<F>& s, Vec3<F> p, Vec3<F> direction) const {
        if (volume.is_mixed())
            return opacity_at(volume, p, direction, 1) - opacity_at(volume, p, direction, -1) > F(another);
        const F half = F(0.5f * edge_mm) * dot(s.gradient, direction);
        const F ahead = opacity_of(s.value + half), behind = opacity_of(s.value - half);
        if (any(s.factor < F(1)))
            return opacity_of_share(ahead, s.factor) - opacity_of_share(behind, s.factor) > F(another);
        return ahead - behind > F(another);
    }

    /// Of extinction per mm over a voxel's smallest edge.
    template <class F>
    CHIARO_INLINE F opacity_of_edge(F kappa) const {
        return F(1) - exp2(F(-1.442695041f * edge_mm) * kappa);
    }

private:
    /// Of a mixture half an edge ahead (1) or behind (-1).
    template <class F, class Volume>
    CHIARO_INLINE F opacity_at(const Volume& volume, Vec3<F> p, Vec3<F> direction, float side) const {
        const Vec3<F> q = volume.clamp(mad(F(0.5f * side * edge_mm), direction, p));
        return opacity_of_edge(alpha_of(volume.matter_at(volume.locate(q, volume.voxel(q)))));
    }

    /// A way in the world, of an edge's length, in voxels.
    template <class F>
    CHIARO_INLINE Vec3<F> from_world(Vec3<F> way) const {
        return mad(way.x, Vec3<F>(world_x), mad(way.y, Vec3<F>(world_y), way.z * Vec3<F>(world_z)));
    }

    /// By the opacities of an edge at -1.5, -.5, 0, .5 and 1.5 edges along the gradient g.
    template <class F>
    CHIARO_INLINE void tell(Vec3<F> g, F slope, const F* opacities, SurfaceAt<F>& s) const {
        const F far_below = opacities[0], below = opacities[1], above = opacities[3], far_above = opacities[4];
        const F sign = select(far_above > far_below, F(-1), F(1));
        s.outward = select(slope > F(1e-12f), sign / max(slope, F(1e-12f)), F(0)) * g;
        const F rise = max(abs(above - below), max(abs(far_above - above), abs(below - far_below)));
        s.hold = min(F(gain) * rise, F(1));
        // Two edges of the densest matter near: an optical depth of ½ is no surface yet, one of 3/2 is.
        const F densest = max(max(far_below, far_above), max(below, above));
        const F depth = F(-2 * 0.6931471806f) * log2(max(F(1) - densest, F(1e-6f)));
        const Mask<F> rising = far_above > far_below;  // with the value
        const F outwards = select(rising, below + far_below, above + far_above);
        s.depth = outwards / max(max(opacities[2], F(0.5f) * outwards), F(1e-6f));
        s.share = s.hold * min(max(depth - F(0.5f), F(0)), F(1));
    }
};

}  // namespace chiaro::kernel

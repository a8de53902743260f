// Light from local histograms, as the ray caster reads it: two words at each node, a colour for each word.
#pragma once
#include "illumination/cells/place.h"
#include "illumination/off_surface.h"
#include "illumination/view.h"
#include "kernel/math.h"
#include "kernel/rgba.h"

namespace chiaro::kernel {

/// How open half a ball is, and what colour comes from what closes it.
template <class F>
struct HalfLight {
    Vec3<F> bleeding;  ///< (1 - v) E / O
    F open;            ///< v
};

struct HistogramView {
    static constexpr bool modulates = true, adds_opacity = true, by_surface = true, remembers_surfaces = true;

    const float* identifiers;        ///< CodewordPair's bits: forward in the low half; x fastest
    GridView grid;                   ///< of the nodes
    const Rgba* codewords;           ///< bleeding, v
    const float* side;               ///< by value: the half ball that faces outwards, 1 forward, -1 backward, 0 neither
    const Rgba* albedo;              ///< by value; of the published model
    float scale, offset;             ///< index by value = stored × scale + offset
    float highest;                   ///< index
    float strength;                  ///< set by the ray caster
    float shows_ao, shows_bleeding;  ///< 0 or 1
    float anisotropy;                ///< g of Henyey and Greenstein
    bool scatters, is_surface, is_paper;
    bool of_surfaces;  ///< samples of surfaces read so far off those
    float lift_edges;
    OffSurface off_surface;
    bool emits;
    const Rgba* emission_codewords;  ///< G and its colour (premultiplied) of one smallest edge, by word
    float step_edges;                ///< length of a step; set by the ray caster
    const std::uint8_t* occupancy;   ///< with the reach of what glows, as volume/occupancy.h reads it

    /// What glows around a sample adds to its step's opacity, α' = max(α, G) (P: only where α is 0), with its own
    /// colour.
    template <class F>
    CHIARO_NOINLINE RgbaLanes<F> emission(const Vec3<F>& p_voxel, const F& alpha) const {
        const Corners<F> corners = locate(p_voxel);
        const Mask<F> all = corners.t.x >= F(0);
        const RgbaLanes<F> around =
            mix<F>(blend(emission_codewords, corners, all), blend(emission_codewords, corners, !all), F(0.5f));
        const F g = min(alpha_of(around), F(0.999f));
        const F of_step = F(1) - exp2(F(step_edges) * log2(F(1) - g));
        const F more = is_paper ? select(alpha > F(0), F(0), of_step) : max(of_step - alpha, F(0));
        return kernel::scale(around, more / max(g, F(1e-6f)));
    }

    CHIARO_INLINE bool asks_surfaces() const { return of_surfaces; }

    /// The more of a surface a sample is, the farther off it reads, of the half ball on the eye's side.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading, const Mask<F>&, F step,
                                       MetSurface<F>& met) const {
        const F share = sample.surface.share;
        const Mask<F> is_new = share > F(0);
        F outwards = gather_float(side, index_of(sample.value));
        Vec3<F> p = sample.p_voxel;
        if (of_surfaces && any(is_new)) {
            const Vec3<F> normal = sample.surface.normal;
            const F edges = share * (F(lift_edges) + sample.surface.depth);
            p = select(is_new, off_surface.place(sample.surface.p_voxel, edges, off_surface.along_grid(normal)), p);
            outwards = select(is_new, F(shading.out) * dot(normal, sample.outward), outwards);
        }
        HalfLight<F> light = arriving(p, outwards, sample, shading);
        if (of_surfaces) {
            met.share = select(is_new, share, met.share);
            met.step = select(is_new, step, met.step);
            met.e = select(is_new, light.bleeding, met.e);
            met.shine.x = select(is_new, light.open, met.shine.x);
            light.bleeding = mad(met.share, met.e - light.bleeding, light.bleeding);
            light.open = mad(met.share, met.shine.x - light.open, light.open);
        }
        return shown(light, sample, shading);
    }
    /// Apart from any ray, and from surfaces.
    template <class F>
    CHIARO_INLINE Incident<F> incident(const SamplePoint<F>& sample, const ShadingView& shading) const {
        return shown(arriving(sample, shading), sample, shading);
    }

    /// Of the half ball that faces outwards by the sample's value.
    template <class F>
    CHIARO_INLINE HalfLight<F> arriving(const SamplePoint<F>& sample, const ShadingView& shading) const {
        return arriving(sample.p_voxel, gather_float(side, index_of(sample.value)), sample, shading);
    }

private:
    template <class F>
    CHIARO_INLINE Incident<F> shown(HalfLight<F> light, const SamplePoint<F>& sample,
                                    const ShadingView& shading) const {
        const Mask<F> on_cut = sample.cut >= F(0);  // nothing lies before one
        light.open = select(on_cut, F(1), light.open);
        light.bleeding = {select(on_cut, F(0), light.bleeding.x), select(on_cut, F(0), light.bleeding.y),
                          select(on_cut, F(0), light.bleeding.z)};
        const Incident<F> local = shading.local(sample);
        if (is_paper && !is_surface) return mixed_as_luma(sample, light, local, shading);
        // What an open flat surface loses to the cells inside it that a sample reads too.
        if (!is_paper) light.open = min(F(1.04f) * light.open, F(1));
        const F ao = F(strength * shows_ao), bleeding = F(strength * shows_bleeding);
        const F closed = F(1) - light.open, access = F(1) - ao * closed;
        // A = v, ρ = v τ + (1 - v) E / O, so each of the two halves of ρ A is its own factor.
        const F own = access * (F(1) - bleeding * closed), others = access * bleeding;
        if (!is_surface)
            return {own * local.diffuse, access * local.specular + others * product(light.bleeding, local.diffuse)};
        // Only the ambient term is occluded.
        const Vec3<F> ambient(F{shading.ambient}, F{shading.ambient}, F{shading.ambient});
        return {(local.diffuse - ambient) + own * ambient,
                local.specular + (others * F(shading.ambient)) * light.bleeding};
    }

    /// Of the half ball that faces outwards, forward (above 0) or backward; where neither does, of both, each as much
    /// as it is open.
    template <class F>
    CHIARO_INLINE HalfLight<F> arriving(const Vec3<F>& p_voxel, F outwards, const SamplePoint<F>& sample,
                                        const ShadingView& shading) const {
        const Mask<F> both = !((outwards > F(0)) | (outwards < F(0)));
        const Corners<F> corners = locate(p_voxel);
        const HalfLight<F> here = half(corners, outwards >= F(0));
        if (!scatters && !any(both)) return here;
        const HalfLight<F> there = half(corners, outwards < F(0));
        F share = is_paper ? F(0.5f) : here.open / max(here.open + there.open, F(1e-6f));
        share = select(both, share, F(1));
        if (scatters) share = scattered(share, sample, shading, outwards >= F(0), both);
        const F rest = F(1) - share;  // 0 leaves `here` as it is, as where no lane has both
        return {share * here.bleeding + rest * there.bleeding, share * here.open + rest * there.open};
    }
    /// Both halves weighted by the phase function of the angle from the light's way to the eye's; at borders half of
    /// that, half of what faces outwards.
    template <class F>
    CHIARO_INLINE F scattered(F share, const SamplePoint<F>& sample, const ShadingView& shading, Mask<F> forward,
                              Mask<F> both) const {
        // Light travels along -l, and cos of the angle between l and the eye's direction is 2 (l · h)² - 1.
        const Float3 l = shading.to_light, h = shading.half;
        const float between = l.x * h.x + l.y * h.y + l.z * h.z, cosine = 1 - 2 * between * between;
        const float along = phase(cosine), against = phase(-cosine);
        const F towards(along / (along + against));
        // rise > 0: the forward half lies on the light's side.
        const F lit = select(sample.rise > F(0), towards, select(sample.rise < F(0), F(1) - towards, F(0.5f)));
        const F here = select(forward, lit, F(1) - lit);
        const F weighted = share * here / max(share * here + (F(1) - share) * (F(1) - here), F(1e-6f));
        return select(both, weighted, F(0.5f) * (F(1) + here));
    }
    /// Henyey and Greenstein, but for a factor.
    CHIARO_INLINE float phase(float cosine) const {
        const float square = 1 + anisotropy * anisotropy - 2 * anisotropy * cosine;
        return 1 / (square * sqrt(square));
    }

    /// Y = min(1 - O, n · l), chroma of lerp(τ, E / O, O), BT.601 (P; spec 3.7).
    template <class F>
    CHIARO_INLINE Incident<F> mixed_as_luma(const SamplePoint<F>& sample, const HalfLight<F>& light,
                                            const Incident<F>& local, const ShadingView& shading) const {
        const Vec3<F> own = planes(load_rgba(albedo, index_of(sample.value))).bleeding;
        const Vec3<F> mixed =
            (F(1) - F(shows_bleeding) * (F(1) - light.open)) * own + F(shows_bleeding) * light.bleeding;
        const F open = F(1) - F(shows_ao) * (F(1) - light.open);
        const F luma = shading.enabled ? min(open, sample.lambert) : open;
        const F grey = luma - dot(Vec3<F>(F(0.299f), F(0.587f), F(0.114f)), mixed);
        const Vec3<F> lit(clamped(mixed.x + grey), clamped(mixed.y + grey), clamped(mixed.z + grey));
        return {F(1 - strength) * local.diffuse, F(strength) * lit + local.specular};
    }

    template <class F>
    struct Corners {
        Four<Two<F>> pairs;
        Vec3<F> t;
    };
    template <class F>
    CHIARO_INLINE Corners<F> locate(Vec3<F> p_voxel) const {
        const GridLocation<F> at = grid.locate(p_voxel);
        return {gather_two(identifiers, typename GatherIndex<F>::type(at.node), grid.rows()), at.t};
    }

    /// Identifiers are names, not numbers: what they stand for is interpolated.
    template <class F>
    CHIARO_INLINE RgbaLanes<F> blend(const Rgba* by_codeword, const Corners<F>& c, Mask<F> forward) const {
        const auto codeword = [&](F pair) CHIARO_INLINE_LAMBDA {
            const Int<F> bits = bits_of(pair);
            return load_rgba(by_codeword, select(forward, bits, bits >> Int<F>(16)) & Int<F>(0xffff));
        };
        const auto along_x = [&](const Two<F>& pair)
                                 CHIARO_INLINE_LAMBDA { return mix<F>(codeword(pair.a), codeword(pair.b), c.t.x); };
        const RgbaLanes<F> near = mix<F>(along_x(c.pairs.a), along_x(c.pairs.b), c.t.y);
        const RgbaLanes<F> far = mix<F>(along_x(c.pairs.c), along_x(c.pairs.d), c.t.y);
        return mix<F>(near, far, c.t.z);
    }
    template <class F>
    CHIARO_INLINE HalfLight<F> half(const Corners<F>& c, Mask<F> forward) const {
        return planes(blend(codewords, c, forward));
    }

    template <ByChannel C>
    static CHIARO_INLINE auto planes(const C& c) {
        return HalfLight<decltype(C::r)>{colour_of(c), alpha_of(c)};
    }
    template <class Pack>
    static CHIARO_INLINE auto planes(const Pack& c) {
        const Pack p = transpose(c.q0, c.q1, c.q2, c.q3);  // its own inverse
        return HalfLight<decltype(Pack::q0)>{{p.q0, p.q1, p.q2}, p.q3};
    }

    template <class F>
    CHIARO_INLINE Int<F> index_of(F stored) const {
        return truncate(min(max(mad(stored, F(scale), F(offset)), F(0)), F(highest)));
    }
    template <class F>
    static CHIARO_INLINE Vec3<F> product(Vec3<F> a, Vec3<F> b) {
        return {a.x * b.x, a.y * b.y, a.z * b.z};
    }
    template <class F>
    static CHIARO_INLINE F clamped(F a) {
        return min(max(a, F(0)), F(1));
    }
};

}  // namespace chiaro::kernel

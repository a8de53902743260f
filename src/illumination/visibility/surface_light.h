// Light on a surface (Ritschel 2007, with the cosine inside the bracket): E = (1/π) Σ V_lm [L max(0, n·ω)]_lm.
#pragma once
#include "illumination/probe/octahedron.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Coefficients of the light for the three channels (and a gap), so that a coefficient of V takes them at once.
struct HarmonicsLight {
    float coefficients[16][4];

    /// Σ V_lm L_lm
    CHIARO_INLINE void add_to(float* sums, const float* visibility) const {
        for (int c = 0; c < 16; ++c)
            for (int k = 0; k < 4; ++k) sums[k] = mad(visibility[c], coefficients[c][k], sums[k]);
    }
};

/// Of one normal. The fourth channel is light of 1 from everywhere.
struct NormalLight {
    static constexpr int channels = 4;
    float bracket[channels][16];  ///< [L max(0, n·ω)]_lm / π
    float zonal[4][channels];     ///< 2π Σ_m of it times Y_lm(n), band by band: what it gives for V around n
};

/// Normals over an unfolded octahedron, in the axes of the grid.
struct SurfaceLight {
    const NormalLight* entries;  ///< u fastest; nullptr: none
    std::int32_t edge;
    float mean;  ///< times the first coefficient of V: its mean

    template <class F>
    CHIARO_INLINE OctahedronCell<F> locate(Vec3<F> n) const {
        return octahedral_cell(n, edge);
    }

    /// Mean of V: the share of even light that arrives.
    template <class Sixteen>
    CHIARO_INLINE float seen(const Sixteen& visibility) const {
        float first[16];
        store(visibility, first);
        return mean * first[0];
    }
    /// Cosine of the horizon of a bulge where V is read, as low as the mean of V tells: -1 to 0.
    template <class Sixteen>
    CHIARO_INLINE float horizon(const Sixteen& visibility) const {
        return min(max(1 - 2 * seen(visibility), -1.0f), 0.0f);
    }
    /// E of three channels (and a fourth) by what the harmonics let through, and `clear` of all the light. What four
    /// bands leave out is known where the surface's own horizon alone stops the light: it is added in proportion to the
    /// share of even light that arrives. `open`: E where nothing hides any of the light.
    template <class Four, class Sixteen>
    CHIARO_INLINE Four shine(const Sixteen& visibility, std::int32_t entry, const float (&weights)[4], float shown,
                             float clear, Four& open) const {
        const NormalLight* at = entries + entry;
        const NormalLight* around[4] = {at, at + 1, at + edge, at + edge + 1};
        Sixteen products[4], zonal(0.0f);
        for (int k = 0; k < 4; ++k) {
            Sixteen bracket(0.0f);
            for (int corner = 0; corner < 4; ++corner)
                bracket = bracket + Sixteen(weights[corner]) * loaded<Sixteen>(around[corner]->bracket[k]);
            products[k] = bracket * visibility;
        }
        for (int corner = 0; corner < 4; ++corner)
            zonal = zonal + Sixteen(weights[corner]) * loaded<Sixteen>(around[corner]->zonal[0]);
        float bands[4][4];
        store(zonal, bands[0]);
        const float x = horizon(visibility), xx = x * x;
        const Four through = sums_of(products), whole = loaded<Four>(bands[0]), lit = whole + whole;
        const Four free = (Four(1 - x) * whole + Four(0.5f * (1 - xx)) * loaded<Four>(bands[1])) +
                          (Four(0.5f * (x - x * xx)) * loaded<Four>(bands[2]) +
                           Four(0.125f * (6 * xx - 5 * xx * xx - 1)) * loaded<Four>(bands[3]));
        float arriving[4];
        store(through + (lit - free), arriving);
        const float even = min(max(arriving[3], 0.0f), 1.0f);
        const Four e = min(max(through + Four(even) * (lit - free), Four(0.0f)), lit);
        open = lit;
        return Four(shown) * e + Four(clear) * lit;
    }
};

}  // namespace chiaro::kernel

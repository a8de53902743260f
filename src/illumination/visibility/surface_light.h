// Light on a surface (Ritschel 2007, with the cosine inside the bracket): E = (ρ/π) Σ V_lm [L max(0, n·ω)]_lm.
#pragma once
#include "illumination/probe/octahedron.h"

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

/// The bracket, divided by π, for normals over an unfolded octahedron.
struct SurfaceLight {
    const HarmonicsLight* entries;  ///< u fastest; nullptr: none
    std::int32_t edge;

    /// Adds weight × E of a surface with the outward normal n, of any length, in the axes of the grid.
    CHIARO_INLINE void add_to(float* sums, const float* visibility, Vec3<float> n, float weight) const {
        const OctahedronPlace<float> place = octahedral(n);
        const float u = place.u * float(edge - 1), v = place.v * float(edge - 1);
        const std::int32_t i = min(truncate(u), edge - 2), j = min(truncate(v), edge - 2);
        const float s = u - float(i), t = v - float(j);
        const HarmonicsLight* at = entries + j * edge + i;
        float e[4] = {0, 0, 0, 0};
        add(e, visibility, at[0], (1 - s) * (1 - t));
        add(e, visibility, at[1], s * (1 - t));
        add(e, visibility, at[edge], (1 - s) * t);
        add(e, visibility, at[edge + 1], s * t);
        for (int k = 0; k < 4; ++k) sums[k] += weight * e[k];
    }

private:
    static CHIARO_INLINE void add(float* sums, const float* visibility, const HarmonicsLight& light, float weight) {
        float e[4] = {0, 0, 0, 0};
        light.add_to(e, visibility);
        for (int k = 0; k < 4; ++k) sums[k] += weight * e[k];
    }
};

}  // namespace chiaro::kernel

// The medium as sweeps meet it, cell by cell.
#pragma once
#include "illumination/transport/light_kernel.h"

namespace chiaro::kernel {

/// Deeper cells let no more through than this one does, 2e-9; what the kernels raise two to stays above -126.
inline constexpr float max_depth = 20;

/// Opaque cells let all pass (their light is looked at and replaced) or, where no ray may find them, nothing.
CHIARO_INLINE float swept_depth(float depth, bool is_opaque, bool is_listed) {
    if (is_opaque) return is_listed ? 0 : max_depth;
    return min(depth, max_depth);
}

/// R(a), what a half space of albedo a reflects of diffuse light (isotropic scattering; van de Hulst 1980), s = √(1 -
/// a).
CHIARO_INLINE float half_space_reflectance(float albedo) {
    const float s = sqrt(max(1 - albedo, 0.0f));
    return (1 - s) * (1 - 0.139f * s) / (1 + 1.17f * s);
}
/// The albedo of which a half space reflects so much: the smaller root s of the same equation.
CHIARO_INLINE float albedo_of_reflectance(float reflectance) {
    const float b = 1.139f + 1.17f * reflectance;
    const float s = (b - sqrt(b * b - 0.556f * (1 - reflectance))) / 0.278f;
    return 1 - s * s;
}
/// Of a cell that is no opaque one, and a surface as far as `share` says: a soft skin over opaque matter, which
/// reflects its albedo, leaves it so if a half space of the skin would reflect the same.
CHIARO_INLINE float albedo_of_skin(float albedo, float share) {
    return share > 0 ? albedo_of_reflectance(lerp(half_space_reflectance(albedo), albedo, share)) : albedo;
}

/// From the grid, x fastest, to its lattices; what lies beside the cells there stays as it is.
struct LatticeKernel {
    CellPlaces places;
    const float *depth, *albedo;  ///< albedo: [channel][cell]
    const float* share;           ///< of surface; nullptr: none
    float resolves_skins;         ///< its part that counts
    const std::uint8_t* clear;    ///< 0: opaque. With a halo of one, as
    const std::int32_t* ids;      ///< below 0: not listed
    std::int64_t field;
    float* extinction;    ///< rows along x, rows along y
    float* swept_albedo;  ///< [channel], rows along x; 0 in opaque cells

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        const std::int64_t in_halo = places.in_halo(cell);
        const bool is_opaque = clear[in_halo] == 0;
        const float swept = swept_depth(depth[cell], is_opaque, ids[in_halo] >= 0);
        const std::int64_t at = places.along_x(cell);
        extinction[at] = swept, extinction[field + places.along_y(cell)] = swept;
        for (std::int32_t c = 0; c < 3; ++c)
            swept_albedo[c * field + at] =
                is_opaque ? 0
                          : albedo_of_skin(albedo[c * places.count() + cell], share ? resolves_skins * share[cell] : 0);
    }
};

/// Of the 2³ cells in one, the mean albedo by extinction.
struct HalvedAlbedoKernel {
    const float *depth, *albedo;    ///< of the finer grid, [channel][cell]
    std::int32_t fine[3], node[3];  ///< cells, nodes
    float* to;                      ///< [channel][node]

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const std::int32_t x = std::int32_t(i % node[0]), y = std::int32_t(i / node[0] % node[1]),
                           z = std::int32_t(i / node[0] / node[1]);
        const std::int64_t cells = std::int64_t(fine[0]) * fine[1] * fine[2],
                           nodes = std::int64_t(node[0]) * node[1] * node[2];
        double colour[3]{}, weight = 0;
        for (std::int32_t k = 2 * z; k < min(2 * z + 2, fine[2]); ++k)
            for (std::int32_t j = 2 * y; j < min(2 * y + 2, fine[1]); ++j)
                for (std::int32_t h = 2 * x; h < min(2 * x + 2, fine[0]); ++h) {
                    const std::int64_t from = (std::int64_t(k) * fine[1] + j) * fine[0] + h;
                    const double extinction = depth[from];
                    for (std::int32_t c = 0; c < 3; ++c) colour[c] += extinction * albedo[c * cells + from];
                    weight += extinction;
                }
        for (std::int32_t c = 0; c < 3; ++c) to[c * nodes + i] = weight > 0 ? float(colour[c] / weight) : 0;
    }
};

/// The colours of a few nodes side by side.
struct GatherKernel {
    const float* colour;  ///< [channel][node]
    std::int64_t nodes;
    const std::size_t* which;
    float* out;  ///< [i][channel]

    CHIARO_INLINE void operator()(std::int64_t i) const {
        for (std::int32_t c = 0; c < 3; ++c) out[3 * i + c] = colour[c * nodes + std::int64_t(which[i])];
    }
};

/// The source of other light, perhaps on another grid: the nearest node's.
struct NearestKernel {
    CellPlaces places;
    const std::int32_t* nearest[3];  ///< of the other grid's nodes, by each coordinate: what it adds to the index
    const float* light;              ///< [node][3]
    const float* albedo[3];
    float* source[3];

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        const std::int64_t at = places.along_x(cell), y = cell / places.nx % places.ny,
                           z = cell / places.nx / places.ny;
        const std::int64_t node = nearest[0][cell % places.nx] + nearest[1][y] + nearest[2][z];
        for (std::int32_t c = 0; c < 3; ++c) source[c][at] = albedo[c][at] * light[3 * node + c];
    }
};

}  // namespace chiaro::kernel

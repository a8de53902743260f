// The colours of the light grid's nodes: sums over their cells, and albedos from those.
#pragma once
#include "illumination/cells/cell_kernel.h"

namespace chiaro::kernel {

struct ScatteringColour {
    float weight = 0;   ///< extinction; of isosurfaces 1
    float colour[3]{};  ///< albedo × weight

    CHIARO_INLINE ScatteringColour times(float share) const {
        return {weight * share, {colour[0] * share, colour[1] * share, colour[2] * share}};
    }
    CHIARO_INLINE void add(const ScatteringColour& other) {
        weight += other.weight;
        for (int c = 0; c < 3; ++c) colour[c] += other.colour[c];
    }
};

/// Over the optical table.
struct ScatteringColourView {
    const ScatteringColour* entries;
    float scale, offset, last;
    float most;  ///< of an albedo's largest channel

    CHIARO_INLINE const ScatteringColour& of(float stored) const {
        return entries[std::uint32_t(min(max(stored * scale + offset, 0.0f), last))];
    }
    /// Of a mixture.
    CHIARO_INLINE ScatteringColour of(Rgba matter) const {
        const float largest = max(max(matter.r, matter.g), matter.b), allowed = most * matter.a;
        const float left = largest > allowed ? allowed / largest : 1;
        return {matter.a, {left * matter.r, left * matter.g, left * matter.b}};
    }
};

/// The stored values of cells, straight from the volume.
template <class Voxel>
struct StoredValues {
    VolumeView<Voxel> volume;
    CellCentres centres;

    CHIARO_INLINE bool is_mixed() const { return volume.is_mixed(); }
    CHIARO_INLINE Rgba matter(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return matter_of_cell(volume, centres, x, y, z);
    }
    static constexpr bool has_tints() { return false; }
    CHIARO_INLINE Rgba tinted(std::int32_t, std::int32_t, std::int32_t, Rgba colour) const { return colour; }
    CHIARO_INLINE bool has_factor() const { return volume.has_factor(); }
    CHIARO_INLINE float factor(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return factor_of_cell(volume, centres, x, y, z);
    }
    CHIARO_INLINE float at(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (centres.are_voxels) return float(*voxel_address(volume, x, y, z));
        const Vec3<float> p = volume.clamp(centres.of(x, y, z));
        return volume.value(volume.locate(p, volume.voxel(p)));
    }
};

/// Sums over nodes of edge³ cells, every `stride`-th per axis. `Values`: at(x, y, z) of a cell, and its factor, or its
/// matter, or what tints its colour.
template <class Values>
struct NodeColours {
    Values values;
    CellCentres centres;
    ScatteringColourView scattering_colours;
    std::int32_t count[4];  ///< cells per axis; the last fills up
    std::int32_t edge, stride;

    CHIARO_INLINE std::int32_t end(int axis, std::int32_t node) const { return min((node + 1) * edge, count[axis]); }
    /// Those of node x in a row of cells.
    CHIARO_INLINE void add_row(std::int32_t x, std::int32_t y, std::int32_t z, ScatteringColour& sum) const {
        for (std::int32_t i = x * edge; i < end(0, x); i += stride) {
            if (values.is_mixed()) {
                if (!centres.is_clipped(i, y, z)) sum.add(scattering_colours.of(values.matter(i, y, z)));
                continue;
            }
            const ScatteringColour& tint = scattering_colours.of(values.at(i, y, z));
            if (tint.weight == 0 || centres.is_clipped(i, y, z)) continue;
            if (values.has_tints()) {
                const Rgba colour{tint.colour[0], tint.colour[1], tint.colour[2], tint.weight};
                sum.add(scattering_colours.of(values.tinted(i, y, z, colour)));
                continue;
            }
            values.has_factor() ? sum.add(tint.times(values.factor(i, y, z))) : sum.add(tint);
        }
    }
};

/// A thread for each node; nothing where there is no matter.
template <class Values>
struct ColourSums {
    NodeColours<Values> colours;
    const float* depths;
    std::int32_t nx, ny;
    ScatteringColour* sums;

    CHIARO_INLINE void operator()(std::int64_t node) const {
        const std::int32_t x = std::int32_t(node % nx), y = std::int32_t(node / nx % ny),
                           z = std::int32_t(node / nx / ny);
        ScatteringColour sum;
        for (std::int32_t k = z * colours.edge; depths[node] > 0 && k < colours.end(2, z); k += colours.stride)
            for (std::int32_t j = y * colours.edge; j < colours.end(1, y); j += colours.stride)
                colours.add_row(x, j, k, sum);
        sums[node] = sum;
    }
};

/// Where matter lies between the places that were looked at: as around it, else as everywhere.
struct AlbedoKernel {
    const float* depths;
    const ScatteringColour* sums;
    std::int32_t nx, ny, nz;
    ScatteringColour everywhere;
    float* albedo[3];

    CHIARO_INLINE void operator()(std::int64_t node) const {
        ScatteringColour tint;
        if (depths[node] > 0) {
            tint = sums[node];
            if (!(tint.weight > 0)) tint = around(node);
            if (!(tint.weight > 0)) tint = everywhere;
        }
        for (int c = 0; c < 3; ++c) albedo[c][node] = tint.weight > 0 ? tint.colour[c] / tint.weight : 0;
    }

private:
    CHIARO_INLINE ScatteringColour around(std::int64_t node) const {
        const std::int32_t x = std::int32_t(node % nx), y = std::int32_t(node / nx % ny),
                           z = std::int32_t(node / nx / ny);
        ScatteringColour sum;
        for (std::int32_t k = max(z - 1, 0); k <= min(z + 1, nz - 1); ++k)
            for (std::int32_t j = max(y - 1, 0); j <= min(y + 1, ny - 1); ++j)
                for (std::int32_t i = max(x - 1, 0); i <= min(x + 1, nx - 1); ++i)
                    sum.add(sums[(std::int64_t(k) * ny + j) * nx + i]);
        return sum;
    }
};

}  // namespace chiaro::kernel

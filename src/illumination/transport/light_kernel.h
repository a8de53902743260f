// What is done to the light of each cell between sweeps. Cells are counted x fastest.
#pragma once
#include "illumination/transport/sweep_kernel.h"
#include "illumination/transport/update_kernel.h"

namespace chiaro::kernel {

/// The numbers of a cell in the two lattices (lattice.h).
struct CellPlaces {
    std::int32_t nx, ny, nz;
    std::int64_t row_x, row_y;

    CHIARO_INLINE std::int64_t count() const { return std::int64_t(nx) * ny * nz; }
    CHIARO_INLINE std::int64_t along_x(std::int64_t cell) const { return row_of(cell) * row_x + x_of(cell); }
    CHIARO_INLINE std::int64_t along_y(std::int64_t cell) const {
        const std::uint32_t yz = row_of(cell), y = yz % std::uint32_t(ny), z = yz / std::uint32_t(ny);
        return (std::int64_t(x_of(cell)) * nz + z) * row_y + y;
    }

    /// In what has a halo of one cell, x fastest.
    CHIARO_INLINE std::int64_t in_halo(std::int64_t cell) const {
        const std::uint32_t yz = row_of(cell), y = yz % std::uint32_t(ny), z = yz / std::uint32_t(ny);
        return (std::int64_t(z + 1) * (ny + 2) + y + 1) * (nx + 2) + x_of(cell) + 1;
    }

private:
    CHIARO_INLINE std::uint32_t row_of(std::int64_t cell) const { return std::uint32_t(cell) / std::uint32_t(nx); }
    CHIARO_INLINE std::uint32_t x_of(std::int64_t cell) const { return std::uint32_t(cell) % std::uint32_t(nx); }
};

/// Light of two colours from several sides has one moment of luminance: each channel's share of it.
CHIARO_INLINE float inverse_luminance(const float (&weights)[3], float r, float g, float b) {
    return 1 / max(weights[0] * r + weights[1] * g + weights[2] * b, 1e-30f);
}
CHIARO_INLINE float moment_of(float of_luminance, float own, float per_luminance) {
    return of_luminance * (own * per_luminance);
}

/// Sums of all groups of directions, added in their order.
struct AddUpKernel {
    static constexpr std::int32_t sums = 6;
    CellPlaces places;
    const float* parts;  ///< [group][sum], numbers of a field each
    std::int64_t field;
    std::int32_t groups, across;  ///< bit g: the rows of group g lie along y
    float luminance[3];
    float* light;   ///< [channel] fields, rows along x, as all that follows
    float* moment;  ///< [channel][axis]

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        const std::int64_t at = places.along_x(cell), turned = places.along_y(cell);
        float sum[sums];
        for (std::int32_t g = 0; g < groups; ++g)
            for (std::int32_t s = 0; s < sums; ++s) {
                const float part = parts[(g * sums + s) * field + (across >> g & 1 ? turned : at)];
                sum[s] = g == 0 ? part : sum[s] + part;
            }
        const float per_luminance = inverse_luminance(luminance, sum[0], sum[1], sum[2]);
        for (std::int32_t c = 0; c < 3; ++c) {
            light[c * field + at] = sum[c];
            for (std::int32_t axis = 0; axis < 3; ++axis)
                moment[(3 * c + axis) * field + at] = moment_of(sum[3 + axis], sum[c], per_luminance);
        }
    }
};

/// A sun's light on top; `mean`: its share that is left in a cell, below 0 in cells that no light reaches.
struct DominantLightKernel {
    CellPlaces places;
    double colour[3], direction[3];
    const double* mean;
    float *light[3], *moment[3][3];

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        const std::int64_t at = places.along_x(cell);
        if (mean[cell] < 0) return;
        for (std::int32_t c = 0; c < 3; ++c) {
            light[c][at] += float(colour[c] * mean[cell]);
            for (std::int32_t axis = 0; axis < 3; ++axis)
                moment[c][axis][at] += float(colour[c] * mean[cell] * direction[axis]);
        }
    }
};

/// Before the first iteration there is the uncollided light.
struct StartKernel {
    CellPlaces places;
    const float *albedo, *first;  ///< [channel]
    std::int64_t field;
    float *source, *mean;

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        for (std::int32_t c = 0; c < 3; ++c) {
            const std::int64_t at = c * field + places.along_x(cell);
            source[at] = albedo[at] * first[at];
            mean[at] = first[at];
        }
    }
};

/// A colour's rows along x to rows along y.
struct TurnKernel {
    CellPlaces places;
    std::int64_t field;
    const float* from;
    float* to;

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        for (std::int32_t c = 0; c < 3; ++c)
            to[c * field + places.along_y(cell)] = from[c * field + places.along_x(cell)];
    }
};

/// UpdateKernel in one cell; its change is kept for ChangeKernel.
struct UpdateCellKernel {
    CellPlaces places;
    UpdateKernel kernel;
    std::int64_t field;
    const float *extinction, *albedo, *first;
    const float* sums;  ///< [side][sum]; those of x: rows along y
    float *source, *mean, *moment;
    float* change;  ///< [2][cell]

    CHIARO_INLINE void operator()(std::int64_t cell) const {
        const std::int64_t at = places.along_x(cell), turned = places.along_y(cell);
        float of_cell[2][16]{};
        UpdateRow row{};
        row.count = 1, row.extinction = extinction + at, row.change = &of_cell;
        for (std::int32_t c = 0; c < 3; ++c) {
            row.albedo[c] = albedo + c * field + at, row.first[c] = first + c * field + at;
            row.source[c] = source + c * field + at, row.mean[c] = mean + c * field + at;
            for (std::int32_t axis = 0; axis < 3; ++axis) row.moment[c][axis] = moment + (3 * c + axis) * field + at;
        }
        constexpr std::int32_t per_side = SourceSweepKernel::sums;
        for (std::int32_t side = 0; side < 6; ++side)
            for (std::int32_t s = 0; s < per_side; ++s)
                row.sums[side][s] = sums + (per_side * side + s) * field + (side < 2 ? turned : at);
        kernel.operator()<float>(row);
        for (std::int32_t i = 0; i < 2; ++i) change[i * places.count() + cell] = of_cell[i][0];
    }
};

/// The sums of a slice by lane, in the order in which rows are taken elsewhere: [z][2][16].
struct ChangeKernel {
    static constexpr std::int32_t lanes = 16;
    CellPlaces places;
    const float* change;
    float* sums;

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const std::int64_t slice = std::int64_t(places.nx) * places.ny, z = i / (2 * lanes);
        const float* of = change + i / lanes % 2 * places.count() + z * slice;
        float sum = 0;
        for (std::int32_t y = 0; y < places.ny; ++y)
            for (std::int32_t x = std::int32_t(i % lanes); x < places.nx; x += lanes) sum += of[y * places.nx + x];
        sums[i] = sum;
    }
};

/// What nodes are made from, rows along x.
struct NodeKernel {
    CellPlaces places;
    const float *mean[3], *moment[3][3], *first_moment[3][3];
    float *light, *moments;  ///< [node][3], [node][3][3]

    CHIARO_INLINE void operator()(std::int64_t node) const { gather(node, places.along_x(node)); }
    CHIARO_INLINE void gather(std::int64_t node, std::int64_t at) const {
        for (std::int32_t c = 0; c < 3; ++c) {
            light[3 * node + c] = mean[c][at];
            for (std::int32_t axis = 0; axis < 3; ++axis)
                moments[9 * node + 3 * c + axis] = moment[c][axis][at] + first_moment[c][axis][at];
        }
    }
};

/// The light that matter has scattered.
struct ScatteredNodeKernel {
    CellPlaces places;
    const float *mean[3], *first[3], *moment[3][3];
    float* scattered;  ///< [node][4][3]

    CHIARO_INLINE void operator()(std::int64_t node) const {
        const std::int64_t at = places.along_x(node);
        for (std::int32_t c = 0; c < 3; ++c) {
            scattered[12 * node + c] = mean[c][at] - first[c][at];
            for (std::int32_t axis = 0; axis < 3; ++axis)
                scattered[12 * node + 3 * (axis + 1) + c] = moment[c][axis][at];
        }
    }
};

}  // namespace chiaro::kernel

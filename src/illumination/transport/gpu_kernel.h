// A sweep as a GPU's threads do it: a thread for each cell of a plane, for each group of directions.
#pragma once
#include "illumination/transport/sweep_kernel.h"
#include "illumination/visibility/swept_places.h"

namespace chiaro::kernel {

/// The cells as one group of directions meets them. Pointers are the GPU's.
struct SweptCells {
    std::int32_t nu, nv, steps;
    SweptPlaces in_field, in_halo;
    const float* extinction;
    const std::int32_t* ids;      ///< of opaque cells, else below 0; with a halo of one
    const std::uint32_t* around;  ///< of these
    OpaqueRow opaque;             ///< without cells
    float* planes[2];             ///< what travels, with a halo of one
    std::int32_t pitch, numbers;  ///< of a row; rows of one v
    std::int32_t behind;          ///< the first batch of the group, planes: its sums in this one are there

    CHIARO_INLINE SweepPlane plane(std::int32_t k) const { return {planes[k & 1], planes[(k + 1) & 1], pitch}; }
    CHIARO_INLINE std::int32_t place(std::int32_t v) const { return (v + 1) * pitch * numbers + 1; }
    CHIARO_INLINE OpaqueCell cell(std::int32_t k, std::int32_t v, std::int32_t u) const {
        const std::int32_t id = ids[in_halo.at(k, v, u)];
        return {u, id, id < 0 ? 0 : around[id]};
    }
};

/// A group of directions, the batch of them that is on its way.
struct FirstSide {
    SweptCells cells;
    FirstSweepKernel kernel;
    float* sums[FirstSweepKernel::sums];

    CHIARO_INLINE void operator()(std::int32_t k, std::int32_t v, std::int32_t u) const {
        FirstSweepKernel here = kernel;
        here.plane = cells.plane(k);
        const std::int64_t at = cells.in_field.at(k, v, 0);
        FirstSweepRow row{cells.place(v), cells.nu, cells.extinction + at, {}, cells.opaque};
        for (std::int32_t s = 0; s < FirstSweepKernel::sums; ++s) row.sums[s] = sums[s] + at;
        here.at(row, cells.cell(k, v, u));
    }
};

struct SourceSide {
    SweptCells cells;
    SourceSweepKernel kernel;
    const float* source[SourceSweepKernel::channels];
    float* sums[SourceSweepKernel::sums];

    CHIARO_INLINE void operator()(std::int32_t k, std::int32_t v, std::int32_t u) const {
        SourceSweepKernel here = kernel;
        here.plane = cells.plane(k);
        const std::int64_t at = cells.in_field.at(k, v, 0);
        SourceRow row{cells.place(v), cells.nu, cells.extinction + at, {}, {}, cells.opaque};
        for (std::int32_t c = 0; c < SourceSweepKernel::channels; ++c) row.source[c] = source[c] + at;
        for (std::int32_t s = 0; s < SourceSweepKernel::sums; ++s) row.sums[s] = sums[s] + at;
        here.at(row, cells.cell(k, v, u));
    }
};

/// One plane of all sides, each `cells` threads; plane k of those that are not behind.
template <class Side>
struct SweepPlaneKernel {
    const Side* sides;
    std::int32_t cells, k;

    CHIARO_INLINE void operator()(std::int64_t i) const {
        const Side& side = sides[std::int32_t(i) / cells];
        const std::int32_t cell = std::int32_t(i) % cells;
        const std::int32_t u = cell % side.cells.nu, v = cell / side.cells.nu;
        const std::int32_t own = k - side.cells.behind;
        if (own >= 0 && own < side.cells.steps && v < side.cells.nv) side(own, v, u);
    }
};

struct FillKernel {
    float* numbers;
    float value;

    CHIARO_INLINE void operator()(std::int64_t i) const { numbers[i] = value; }
};

}  // namespace chiaro::kernel

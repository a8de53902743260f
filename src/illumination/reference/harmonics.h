// What rays find, projected to spherical harmonics: one direction for sixteen nodes along x.
#pragma once
#include "illumination/reference/kernel.h"

namespace chiaro::kernel {

/// Sixteen nodes along x: the first one's cell and place in its row, and the row.
struct NodeRun {
    std::int32_t x, place, y, z;
};

/// Σ V Y of the sixteen nodes, by coefficient.
struct HarmonicSums {
    static constexpr std::int32_t coefficients = 16;
    double at[coefficients][NodeColumn::width];
};

template <class Rays>
struct HarmonicsKernel {
    Rays rays;
    std::int32_t stride;                           ///< cells between two nodes
    double harmonics[HarmonicSums::coefficients];  ///< Y of the direction

    template <class F>
    CHIARO_INLINE void operator()(const NodeRun& run, HarmonicSums& sums) const {
        float cell_x[NodeColumn::width];
        for (std::int32_t i = 0; i < NodeColumn::width; ++i) cell_x[i] = float(run.x + i * stride);
        const NodeColumn nodes{.x = run.x, .stride = stride, .place = run.place, .cell_x = cell_x};
        float open[NodeColumn::width];
        for (std::int32_t lane = 0; lane < NodeColumn::width; lane += LaneTraits<F>::count)
            store_row(open + lane, transmittance(rays.template depth<F>(nodes, lane, run.y, run.z, F(0))));
        for (std::int32_t c = 0; c < HarmonicSums::coefficients; ++c)
            for (std::int32_t i = 0; i < NodeColumn::width; ++i) sums.at[c][i] += double(open[i]) * harmonics[c];
    }
};

}  // namespace chiaro::kernel

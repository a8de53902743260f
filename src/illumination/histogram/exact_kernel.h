// Brute force over the ball for one cell, or sixteen neighbours along x.
#pragma once
#include "illumination/histogram/ball_view.h"
#include "kernel/first.h"
#include "kernel/row.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

/// Adds to each lane's place of both histograms: lanes with the same place at once, since neighbours mostly agree.
template <class F>
CHIARO_INLINE void add_to_places(const std::uint16_t* places, F all, F forward, float* histogram_all,
                                 float* histogram_forward) {
    const F place = load_row<F>(places);
    Mask<F> left = place >= F(0);
    while (any(left)) {
        const int here = places[first_of(left)];
        const Mask<F> same = left & (place == F(float(here)));
        float* const to_all = histogram_all + here * run_lanes;
        float* const to_forward = histogram_forward + here * run_lanes;
        store_row(to_all, load_row<F>(to_all) + select(same, all, F(0)));
        store_row(to_forward, load_row<F>(to_forward) + select(same, forward, F(0)));
        left = left & !same;
    }
}

/// `places` points at the first cell in a tile that holds the ball around all of them. Histograms are [place][cell] and
/// zero at first: of the whole ball, and of its half that the gradient points to.
template <class F>
CHIARO_INLINE void exact_histograms(const BallView& ball, const PlaceTile& tile, const float* gradient, float* all,
                                    float* forward) {
    const Vec3<F> g{load_row<F>(gradient), load_row<F>(gradient + run_lanes), load_row<F>(gradient + 2 * run_lanes)};
    for (std::int32_t i = 0; i < ball.rows; ++i) {
        const BallRow row = ball.row[i];
        const std::uint16_t* const places = tile.first + row.dz * tile.slice + row.dy * tile.row;
        const F across = mad(F(float(row.dz)), g.z, F(float(row.dy)) * g.y);
        const std::int32_t square = row.dy * row.dy + row.dz * row.dz;
        for (std::int32_t dx = -row.reach; dx <= row.reach; ++dx) {
            const F weight(ball.weight[square + dx * dx]);
            const F ahead = mad(F(float(dx)), g.x, across);
            const F share = select(ahead > F(0), F(1), select(ahead < F(0), F(0), F(0.5f)));
            add_to_places<F>(places + dx, weight, weight * share, all, forward);
        }
    }
}

/// Adds one cell's histogram of a half ball (of the whole, where `whole`) to `histogram`: a row of weights at a time,
/// and none of those on the other side. Weights are those of exact_histograms.
CHIARO_INLINE void exact_half(const BallView& ball, const PlaceTile& tile, const float* gradient, bool whole,
                              float* histogram) {
    float weights[BallView::most_reach * 2 + 1];
    for (std::int32_t i = 0; i < ball.rows; ++i) {
        const BallRow row = ball.row[i];
        const float across = mad(float(row.dz), gradient[2], float(row.dy) * gradient[1]);
        const float ends = abs(gradient[0]) * float(row.reach);
        if (!whole && across + ends < 0) continue;
        const std::uint16_t* const places = tile.first + row.dz * tile.slice + row.dy * tile.row - row.reach;
        const std::int32_t square = row.dy * row.dy + row.dz * row.dz, count = 2 * row.reach + 1;
        for (std::int32_t k = 0; k < count; ++k) {
            const std::int32_t dx = k - row.reach;
            const float ahead = mad(float(dx), gradient[0], across), weight = ball.weight[square + dx * dx];
            weights[k] = whole ? weight : weight * (ahead > 0 ? 1.0f : ahead < 0 ? 0.0f : 0.5f);
        }
        for (std::int32_t k = 0; k < count; ++k) histogram[places[k]] += weights[k];
    }
}

/// The first `count` cells of a run; gradients and histograms as above, of cell i at [i].
template <class F>
CHIARO_INLINE void exact_run(const BallView& ball, PlaceTile tile, const float* gradient, std::int32_t count,
                             float* all, float* forward) {
    constexpr int lanes = LaneTraits<F>::count;
    for (int i = 0; i < count; i += lanes)
        exact_histograms<F>(ball, {tile.first + i, tile.row, tile.slice}, gradient + i, all + i, forward + i);
}

}  // namespace chiaro::kernel

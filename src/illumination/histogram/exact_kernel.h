// Brute force over the ball around a cell: the weights of a row of its neighbours in plain loops that the compiler
// turns into vectors; then each is counted.
#pragma once
#include "illumination/histogram/ball_view.h"
#include "illumination/histogram/bin_grid.h"
#include "illumination/histogram/codebook_view.h"
#include "kernel/prefetch.h"

namespace chiaro::kernel {

/// A half ball's share of what was counted ahead of the gradient and in the whole ball.
CHIARO_INLINE float half_of(float ahead, float all, bool backward) {
    return 2 * (backward ? max(all - ahead, 0.0f) : ahead);
}
/// packed_one for 1
CHIARO_INLINE std::int16_t packed_share(float share) {
    return std::int16_t(min(max(share, 0.0f), 1.0f) * float(packed_one) + 0.5f);
}

CHIARO_INLINE float scale_of(BallPart part) { return part == BallPart::whole ? 1.0f : 2.0f; }

/// Around a cell whose places are its bins.
CHIARO_INLINE CellNeighbours places_around(const BinGrid& grid, int x, int y, int z) {
    const std::int32_t* n = grid.count;
    return {grid.cell(x, y, z), n[0], n[0] * n[1], {x, y, z}, {n[0] - 1 - x, n[1] - 1 - y, n[2] - 1 - z}};
}

/// Adds weights to their places in four copies of a histogram in turn, because adding to the same number again and
/// again would wait for itself.
CHIARO_INLINE void count_row(const std::uint16_t* place, const float* weight, std::int32_t count, std::int32_t places,
                             float* counts) {
    std::int32_t k = 0;
    for (; k + 4 <= count; k += 4) {
        counts[place[k]] += weight[k];
        counts[places + place[k + 1]] += weight[k + 1];
        counts[2 * places + place[k + 2]] += weight[k + 2];
        counts[3 * places + place[k + 3]] += weight[k + 3];
    }
    for (; k < count; ++k) counts[place[k]] += weight[k];
}

/// The fours of a row of `count` cells among which some are not behind the plane between the halves: [first, end).
struct FoursAhead {
    std::int32_t first, end;

    /// The plane meets the row where `across` + x `along` is 0; x = `from` at its first cell. Rounding is far below the
    /// two cells to spare.
    CHIARO_INLINE FoursAhead(float across, float along, std::int32_t from, std::int32_t count) : first(0), end(count) {
        constexpr float most = 4 * BallView::max_reach;
        if (along == 0) return;
        const float meets = min(max(-across / along, -most), most) - float(from);
        if (along > 0)
            first = min(count, max(std::int32_t(meets) - 2, 0) / 4 * 4);
        else
            end = min(count, max(std::int32_t(meets) + 6, 0) / 4 * 4);
    }
};

CHIARO_INLINE bool is_inside(const CellNeighbours& cell, const BallRow& row) {
    return row.dy >= -cell.before[1] && row.dy <= cell.behind[1] && row.dz >= -cell.before[2] &&
           row.dz <= cell.behind[2];
}
/// Rows of a ball lie too far apart for the processor to guess the next one.
inline constexpr std::int32_t rows_ahead = 8;
CHIARO_INLINE void ask_for(const CellNeighbours& cell, const BallRow& row) {
    if (!is_inside(cell, row)) return;
    const std::uint16_t* const middle = cell.here + row.dz * cell.slice + row.dy * cell.row;
    prefetch_read(middle - min(row.reach, cell.before[0])), prefetch_read(middle + min(row.reach, cell.behind[0]));
}

/// Adds the cells of the ball on the gradient's side, or where `whole` all, to `counts`, [4][places]. Cells in the
/// plane between the halves count half.
CHIARO_INLINE void count_ball(const BallView& ball, const CellNeighbours& cell, const float* gradient, bool whole,
                              std::int32_t places, float* counts) {
    float weights[BallView::max_reach * 2 + 1];
    const float* middle = ball.weights;
    for (std::int32_t i = 0; i < ball.rows; middle += ball.row[i++].reach + 1) {
        const BallRow row = ball.row[i];
        middle += row.reach;
        ask_for(cell, ball.row[min(i + rows_ahead, ball.rows - 1)]);
        if (!is_inside(cell, row)) continue;
        const float across = mad(float(row.dz), gradient[2], float(row.dy) * gradient[1]);
        const float ends = abs(gradient[0]) * float(row.reach);
        if (!whole && across + ends < 0) continue;  // all of it lies behind
        const std::int32_t from = max(-row.reach, -cell.before[0]), count = min(row.reach, cell.behind[0]) - from + 1;
        const std::uint16_t* const places_there = cell.here + row.dz * cell.slice + row.dy * cell.row + from;
        if (whole) {
            count_row(places_there, middle + from, count, places, counts);
            continue;
        }
        const FoursAhead fours(across, gradient[0], from, count);
        for (std::int32_t k = fours.first; k < fours.end; ++k) {
            const float ahead = mad(float(from + k), gradient[0], across);
            weights[k] = middle[from + k] * (ahead > 0 ? 1.0f : ahead < 0 ? 0.0f : 0.5f);
        }
        count_row(places_there + fours.first, weights + fours.first, fours.end - fours.first, places, counts);
    }
}

/// The four copies of count `k` together.
CHIARO_INLINE float count_of(const float* counts, std::int32_t places, std::int32_t k) {
    return (counts[k] + counts[places + k]) + (counts[2 * places + k] + counts[3 * places + k]);
}

}  // namespace chiaro::kernel

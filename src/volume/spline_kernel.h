// Rows of a spline's numbers: coefficients from voxels, their codes, and between which of these the spline lies. Plain
// loops that the compiler turns into vectors, or over the lanes F of one; the same bits from every instruction set.
#pragma once
#include <cstddef>

#include "kernel/row.h"
#include "volume/bricks.h"

namespace chiaro::kernel {

/// n rows of `lanes` numbers, `stride` numbers apart, as the lines of one axis: lane by lane.
struct Lines {
    float* first;
    std::ptrdiff_t stride;
    int n, lanes;
    CHIARO_INLINE float* row(int i) const { return first + i * stride; }
};

/// The numbers c with (c[i - 1] + 4 c[i] + c[i + 1]) / 6 = v[i], straight on at both ends (a natural spline, which
/// reproduces linear ramps), in place: by elimination (Thomas). factors[i] = 1 / (4 - factors[i - 1]), of row 0 it is
/// 0.
CHIARO_INLINE void to_coefficients(const Lines& v, const float* factors) {
    for (int i = 1; i + 1 < v.n; ++i) {
        float* __restrict here = v.row(i);
        const float* before = v.row(i - 1);
        for (int lane = 0; lane < v.lanes; ++lane) here[lane] = (6 * here[lane] - before[lane]) * factors[i];
    }
    for (int i = v.n - 2; i > 0; --i) {
        float* __restrict here = v.row(i);
        const float* behind = v.row(i + 1);
        for (int lane = 0; lane < v.lanes; ++lane) here[lane] -= factors[i] * behind[lane];
    }
}

/// (v[i - 1] + 4 v[i] + v[i + 1]) / 6, in place; beyond the ends the last number stands. `before`: scratch for a row.
CHIARO_INLINE void smooth(const Lines& v, float* __restrict before) {
    __builtin_memcpy(before, v.row(0), std::size_t(v.lanes) * sizeof(float));
    for (int i = 0; i + 1 < v.n; ++i) {
        float* __restrict here = v.row(i);
        const float* behind = v.row(i + 1);
        for (int lane = 0; lane < v.lanes; ++lane) {
            const float was = here[lane];
            here[lane] = (before[lane] + 4 * was + behind[lane]) * (1.0f / 6);
            before[lane] = was;
        }
    }
    float* last = v.row(v.n - 1);
    for (int lane = 0; lane < v.lanes; ++lane) last[lane] = (before[lane] + 4 * last[lane] + last[lane]) * (1.0f / 6);
}

/// The least and the largest of n numbers.
template <class F>
CHIARO_INLINE void find_range(const float* numbers, int n, float& low, float& high) {
    constexpr int lanes = LaneTraits<F>::count;
    F least(numbers[0]), largest = least;
    int i = 0;
    for (; i + lanes <= n; i += lanes) {
        const F some = load_row<F>(numbers + i);
        least = min(least, some), largest = max(largest, some);
    }
    float of_lane[2][lanes];
    store_row(of_lane[0], least), store_row(of_lane[1], largest);
    low = of_lane[0][0], high = of_lane[1][0];
    for (const float number : of_lane[0]) low = min(low, number);
    for (const float number : of_lane[1]) high = max(high, number);
    for (; i < n; ++i) low = min(low, numbers[i]), high = max(high, numbers[i]);
}

/// What coefficients stand for: stored = (code - base) * scale + least.
struct Coding {
    float base, scale, least;
};
/// To the nearest codes, halves away from zero.
template <class Code>
CHIARO_INLINE void to_codes(const float* __restrict values, int n, const Coding& coding, Code* __restrict codes) {
    constexpr float last = sizeof(Code) == 1 ? 255 : 65535;
    for (int i = 0; i < n; ++i) {
        const float steps = (values[i] - coding.least) / coding.scale, whole = float(std::int32_t(steps));
        const float rest = steps - whole, away = rest >= 0.5f ? 1.0f : rest <= -0.5f ? -1.0f : 0.0f;
        codes[i] = Code(std::int32_t(min(max(whole + away + coding.base, 0.0f), last)));
    }
}

/// Numbers that are stored as they are.
CHIARO_INLINE void to_codes(const float* values, int n, const Coding&, float* codes) {
    __builtin_memcpy(codes, values, std::size_t(n) * sizeof(float));
}

inline constexpr int cells_per_brick = brick_edge / cell_edge;  ///< along an axis
/// Of a brick's cells, x fastest.
struct CellBounds {
    float low[cells_per_brick * cells_per_brick * cells_per_brick];
    float high[cells_per_brick * cells_per_brick * cells_per_brick];

    /// Of the cell that begins at a voxel of the brick.
    template <class Corner>
    static CHIARO_INLINE std::size_t index(const Corner& corner) {
        return std::size_t((corner[2] / cell_edge * cells_per_brick + corner[1] / cell_edge) * cells_per_brick +
                           corner[0] / cell_edge);
    }
};

/// Between which codes the spline lies in the cells of a brick: those of coefficients for knots half as far apart (Lane
/// and Riesenfeld 1980), which bound it about twice as tightly. Knots are found once for all cells that share them.
template <class F>
class RefinedBrick {
public:
    /// Of a brick, whose first `slices` slices are there, those layers of cells whose bit is set.
    template <class Code>
    CHIARO_INLINE void find(const Code* brick, int slices, unsigned layers, CellBounds& bounds) {
        int ready = 0;  // planes below lie in their place, those that a layer needs
        for (int layer = 0; layer < cells_per_brick; ++layer) {
            if (!(layers >> layer & 1)) continue;
            const int first = layer * cell_edge;
            for (int plane = max(ready, first); plane < first + deep; ++plane)
                refine(brick + min(plane, slices - 1) * brick_slice, planes_[plane % deep]);
            ready = first + deep;
            find_layer(first, bounds.low + layer * cells_per_brick * cells_per_brick,
                       bounds.high + layer * cells_per_brick * cells_per_brick);
        }
    }

private:
    static constexpr int deep = cell_edge + 3;      ///< coefficients that a cell's values depend on, per axis
    static constexpr int fine = 2 * brick_row - 3;  ///< knots in a row of a brick
    static constexpr int reach = 2 * deep - 3;      ///< knots of a cell
    // Along x first the knots between two coefficients, then those at one: sixteen lanes at a time.
    static constexpr int at_one = brick_row - 1, width = (fine + 15) / 16 * 16;
    struct alignas(64) Row {
        float knots[width + 16];
    };

    static CHIARO_INLINE F between(F a, F b) { return F(0.5f) * (a + b); }
    static CHIARO_INLINE F at(F a, F b, F c) { return F(0.125f) * (a + c) + F(0.75f) * b; }

    /// Along x, then y.
    template <class Code>
    static CHIARO_INLINE void refine(const Code* slice, Row* plane) {
        constexpr int lanes = LaneTraits<F>::count;
        Row rows[brick_row];
        constexpr int written = 48;
        float numbers[written + 2] = {};
        for (int y = 0; y < brick_row; ++y) {
            for (int x = 0; x < brick_row; ++x) numbers[x] = float(slice[y * brick_row + x]);
            float* knots = rows[y].knots;
            for (int x = 0; x < written; x += lanes)
                store_row(knots + x, between(load_row<F>(numbers + x), load_row<F>(numbers + x + 1)));
            for (int x = 0; x < written; x += lanes)
                store_row(knots + at_one + x,
                          at(load_row<F>(numbers + x), load_row<F>(numbers + x + 1), load_row<F>(numbers + x + 2)));
        }
        for (int y = 0; y + 1 < brick_row; ++y)
            for (int x = 0; x < width; x += lanes) {
                const F a = load_row<F>(rows[y].knots + x), b = load_row<F>(rows[y + 1].knots + x);
                store_row(plane[2 * y].knots + x, between(a, b));
                if (y + 2 < brick_row)
                    store_row(plane[2 * y + 1].knots + x, at(a, b, load_row<F>(rows[y + 2].knots + x)));
            }
    }

    /// Of a layer of cells: along z, whose knots are not kept, then over each cell's knots along y and x.
    CHIARO_INLINE void find_layer(int first, float* low, float* high) {
        constexpr int lanes = LaneTraits<F>::count;
        for (int y = 0; y < fine; ++y)
            for (int x = 0; x < width; x += lanes) {
                F c[deep];
                for (int i = 0; i < deep; ++i) c[i] = load_row<F>(planes_[(first + i) % deep][y].knots + x);
                F least = between(c[0], c[1]), largest = least;
                for (int i = 0; i + 2 < deep; ++i) {
                    const F knot = at(c[i], c[i + 1], c[i + 2]), next = between(c[i + 1], c[i + 2]);
                    least = min(least, min(knot, next)), largest = max(largest, max(knot, next));
                }
                store_row(least_[y].knots + x, least), store_row(largest_[y].knots + x, largest);
            }
        for (int cell = 0; cell < cells_per_brick; ++cell) {
            reduce(least_ + cell * 2 * cell_edge, low + cell * cells_per_brick,
                   [](F a, F b) CHIARO_INLINE_LAMBDA { return min(a, b); });
            reduce(largest_ + cell * 2 * cell_edge, high + cell * cells_per_brick,
                   [](F a, F b) CHIARO_INLINE_LAMBDA { return max(a, b); });
        }
    }

    /// Over the knots of a row of cells.
    template <class Op>
    static CHIARO_INLINE void reduce(const Row* rows, float* of_cells, const Op& op) {
        constexpr int lanes = LaneTraits<F>::count;
        float all[width], from[brick_edge];  // of columns, and of as many as a cell's from each on
        for (int x = 0; x < width; x += lanes) {
            F found = load_row<F>(rows[0].knots + x);
            for (int y = 1; y < reach; ++y) found = op(found, load_row<F>(rows[y].knots + x));
            store_row(all + x, found);
        }
        for (int x = 0; x < brick_edge; x += lanes) {
            F found = load_row<F>(all + x);
            for (int i = 1; i < deep - 1; ++i) found = op(found, load_row<F>(all + x + i));
            for (int i = 0; i < deep - 2; ++i) found = op(found, load_row<F>(all + at_one + x + i));
            store_row(from + x, found);
        }
        for (int cell = 0; cell < cells_per_brick; ++cell) of_cells[cell] = from[cell * cell_edge];
    }

    Row planes_[deep][fine], least_[fine], largest_[fine];
};

}  // namespace chiaro::kernel

// Histograms of a block of cells by sums over boxes, in vectors of packed bins, a bin to a lane. Far cells are summed
// as coarse ones of 2³, exactly in integers; near ones are counted one by one.
#pragma once
#include "illumination/histogram/codebook_view.h"
#include "illumination/histogram/fast_block.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Adds (or takes away) a coarse cell to a column: each of its eight cells has up to two neighbouring packed bins.
template <int sign>
CHIARO_INLINE void add_coarse_cell(const FastBlock& b, int x, int y, int z, std::int32_t* column) {
    const std::uint32_t* cell = b.tile + 2 * x + std::int64_t(2 * y) * b.tile_row + std::int64_t(2 * z) * b.tile_slice;
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                const std::uint32_t code = cell[i + j * b.tile_row + k * b.tile_slice];
                std::int32_t* const bin = column + (code & 0xff);
                bin[0] += sign * std::int32_t(code >> 8 & 0x1ff);
                if (code >> 17) bin[1] += sign * std::int32_t(code >> 17);
            }
}

template <class F>
CHIARO_INLINE Int<F> load_counts(const std::int32_t* from) {
    return bits_of(load_row<F>(reinterpret_cast<const float*>(from)));
}
CHIARO_INLINE void store_counts(std::int32_t* to, std::int32_t counts) { *to = counts; }
template <class I>
CHIARO_INLINE void store_counts(std::int32_t* to, I counts) {
    store_row(reinterpret_cast<float*>(to), float_of(counts));
}

/// use(i, Σ in[i .. i + 2 h]) for vectors that lie `step` apart; as many bins as there are lanes.
template <class F, class Use>
CHIARO_INLINE void running_sums(const std::int32_t* in, int step, int count, int h, Use&& use) {
    Int<F> sum(0);
    for (int i = 0; i < 2 * h; ++i) sum = sum + load_counts<F>(in + i * step);
    for (int i = 0; i < count; ++i) {
        sum = sum + load_counts<F>(in + (i + 2 * h) * step);
        use(i, sum);
        sum = sum - load_counts<F>(in + i * step);
    }
}

template <class F>
CHIARO_INLINE void add_to_row(const std::int32_t* counts, int n, std::int32_t* sums) {
    for (int i = 0; i < n; i += LaneTraits<F>::count)
        store_counts(sums + i, load_counts<F>(sums + i) + load_counts<F>(counts + i));
}

/// Columns of coarse cells that several boxes share: how far they reach around the nodes.
struct Columns {
    std::int32_t reach_x, reach_y, half_z;
    CHIARO_INLINE int width() const { return FastBlock::nodes + 2 * reach_x; }
    CHIARO_INLINE int height() const { return FastBlock::nodes + 2 * reach_y; }
};

/// One plane of nodes: box sums of the columns over x and y, weighted into both filters.
template <class F>
CHIARO_INLINE void add_box_plane(const FastBlock& b, const Columns& columns, const FastBox& box, int z) {
    constexpr int nodes = FastBlock::nodes, lanes = LaneTraits<F>::count;
    const int bins = b.bins, row = nodes * bins;
    for (int y = 0; y < nodes + 2 * box.half_y; ++y) {
        const int column = (y + columns.reach_y - box.half_y) * columns.width() + columns.reach_x - box.half_x;
        for (int g = 0; g < bins; g += lanes) {
            std::int32_t* const out = b.rows + y * row + g;
            running_sums<F>(b.columns + column * bins + g, bins, nodes, box.half_x,
                            [&](int i, Int<F> sum) CHIARO_INLINE_LAMBDA { store_counts(out + i * bins, sum); });
        }
    }
    for (int i = 0; i < row; ++i) b.row_sum[i] = 0;
    for (int y = 0; y < 2 * box.half_y; ++y) add_to_row<F>(b.rows + y * row, row, b.row_sum);
    const F of_mass(box.mass), of_blur(box.blur);
    for (int y = 0; y < nodes; ++y) {
        const std::int32_t *const ahead = b.rows + (y + 2 * box.half_y) * row, *const behind = b.rows + y * row;
        float *const mass = b.mass + (z * nodes + y) * row, *const blur = b.blur + (z * nodes + y) * row;
        for (int i = 0; i < row; i += lanes) {
            const Int<F> sum = load_counts<F>(b.row_sum + i) + load_counts<F>(ahead + i);
            store_row(mass + i, mad(of_mass, to_float(sum), load_row<F>(mass + i)));
            store_row(blur + i, mad(of_blur, to_float(sum), load_row<F>(blur + i)));
            store_counts(b.row_sum + i, sum - load_counts<F>(behind + i));
        }
    }
}

/// Adds plane `z` of the tile's coarse cells to the columns, or takes it away.
template <int sign>
CHIARO_INLINE void add_coarse_plane(const FastBlock& b, const Columns& columns, int z) {
    std::int32_t* column = b.columns;
    for (int y = 0; y < columns.height(); ++y)
        for (int x = 0; x < columns.width(); ++x, column += b.bins)
            add_coarse_cell<sign>(b, b.reach - columns.reach_x + x, b.reach - columns.reach_y + y, z, column);
}

/// The boxes of one half_z, [from, end).
template <class F>
CHIARO_INLINE void add_boxes(const FastBlock& b, int from, int end) {
    Columns columns{0, 0, b.box[from].half_z};
    for (int n = from; n < end; ++n) {
        columns.reach_x = max(columns.reach_x, b.box[n].half_x);
        columns.reach_y = max(columns.reach_y, b.box[n].half_y);
    }
    for (int i = 0; i < columns.width() * columns.height() * b.bins; ++i) b.columns[i] = 0;
    const int first = b.reach - columns.half_z;
    for (int z = 0; z < 2 * columns.half_z; ++z) add_coarse_plane<1>(b, columns, first + z);
    for (int z = 0; z < FastBlock::nodes; ++z) {
        add_coarse_plane<1>(b, columns, first + z + 2 * columns.half_z);
        for (int n = from; n < end; ++n) add_box_plane<F>(b, columns, b.box[n], z);
        add_coarse_plane<-1>(b, columns, first + z);
    }
}

/// Both filters at all nodes of a block: M0 of the far cells, and P whose gradient is their M1.
template <class F>
CHIARO_INLINE void fast_sums(const FastBlock& b) {
    constexpr int nodes = FastBlock::nodes;
    for (int i = 0; i < nodes * nodes * nodes * b.bins; ++i) b.mass[i] = 0, b.blur[i] = 0;
    for (int from = 0, end = 0; from < b.boxes; from = end) {
        while (end < b.boxes && b.box[end].half_z == b.box[from].half_z) ++end;
        add_boxes<F>(b, from, end);
    }
}

/// Of a fine index: the node before it (nodes lie at 2 i + ½; two more come before the block) and the next one's share.
struct Between {
    int node;
    float next;
};
CHIARO_INLINE Between between(int fine) { return {(fine + 3) / 2, fine % 2 ? 0.25f : 0.75f}; }

/// s a + t b
template <class F>
CHIARO_INLINE F blend(F s, const float* a, F t, const float* b) {
    return mad(t, load_row<F>(b), s * load_row<F>(a));
}
/// The difference over two nodes, s of it between `before` and `next`, t one node on.
template <class F>
CHIARO_INLINE F blend_slope(F s, F t, const float* here, std::int64_t step) {
    const F before = load_row<F>(here - step), at = load_row<F>(here), next = load_row<F>(here + step),
            behind = load_row<F>(here + 2 * step);
    return mad(t, behind - at, s * (next - before));
}

/// A plane of fine cells: M0, P and its difference along z, interpolated between planes of nodes.
template <class F>
CHIARO_INLINE void fast_plane(const FastBlock& b, int fine_z) {
    const std::int64_t plane = std::int64_t(FastBlock::nodes) * FastBlock::nodes * b.bins;
    const Between at = between(fine_z);
    const float *const m = b.mass + at.node * plane, *const p = b.blur + at.node * plane;
    const F t(at.next), s(1 - at.next);
    for (std::int64_t i = 0; i < plane; i += LaneTraits<F>::count) {
        store_row(b.plane + i, blend(s, m + i, t, m + i + plane));
        store_row(b.plane + plane + i, blend(s, p + i, t, p + i + plane));
        store_row(b.plane + 2 * plane + i, blend_slope(s, t, p + i, plane));
    }
}

/// The same for a row of the plane; differences along y and z.
template <class F>
CHIARO_INLINE void fast_row(const FastBlock& b, int fine_y) {
    const std::int64_t row = std::int64_t(FastBlock::nodes) * b.bins, plane = FastBlock::nodes * row;
    const Between at = between(fine_y);
    const float *const m = b.plane + at.node * row, *const p = m + plane, *const dz = p + plane;
    const F t(at.next), s(1 - at.next);
    for (std::int64_t i = 0; i < row; i += LaneTraits<F>::count) {
        store_row(b.line + i, blend(s, m + i, t, m + i + row));
        store_row(b.line + row + i, blend(s, p + i, t, p + i + row));
        store_row(b.line + 2 * row + i, blend_slope(s, t, p + i, row));
        store_row(b.line + 3 * row + i, blend(s, dz + i, t, dz + i + row));
    }
}

/// Counts the cells near one cell by their true side of it; `forward` and `backward` are zero at first.
CHIARO_INLINE void count_near(const FastBlock& b, const std::uint32_t* cell, const float* n, float* forward,
                              float* backward) {
    float to_forward[FastBlock::most_near];
    for (int i = 0; i < b.near_count; ++i) {
        const NearCell& c = b.near[i];
        const float ahead = mad(c.x, n[0], mad(c.y, n[1], c.z * n[2]));
        to_forward[i] = ahead > 0 ? c.weight : ahead < 0 ? 0 : 0.5f * c.weight;
    }
    for (int i = 0; i < b.near_count; ++i) {
        const std::uint32_t code = cell[b.near[i].distance];
        const float f = to_forward[i], r = b.near[i].weight - f;
        const int bin = int(code & 0xff);
        const float first = float(code >> 8 & 0x1ff), second = float(code >> 17);
        forward[bin] += first * f, backward[bin] += first * r;
        if (code >> 17) forward[bin + 1] += second * f, backward[bin + 1] += second * r;
    }
}

template <class F>
CHIARO_INLINE void store_histogram(F share, std::int16_t* to) {
    store_whole(truncate(min(max(share, F(0)), F(1)) * F(float(packed_one)) + F(0.5f)),
                reinterpret_cast<std::uint16_t*>(to));
}

/// Both histograms of one cell of a row that is interpolated: M0 ± M1 (3/2 + 2 q²), q = n · M1 / M0, and what was
/// counted near it; packed_one for 1. `n` is ∇f of length 1, or 0.
template <class F>
CHIARO_INLINE void finish_cell(const FastBlock& b, int fine_x, const float* n, std::int16_t* histograms) {
    const std::int64_t row = std::int64_t(FastBlock::nodes) * b.bins;
    const int bins = b.bins;
    const Between at = between(fine_x);
    const F t(at.next), s(1 - at.next), nx(n[0]), ny(n[1]), nz(n[2]);
    const float *const m = b.line + at.node * bins, *const p = m + row, *const dy = p + row, *const dz = dy + row;
    for (int k = 0; k < bins; k += LaneTraits<F>::count) {
        const F mass = max(blend(s, m + k, t, m + k + bins), F(0));
        const F moment = mad(nx, blend_slope(s, t, p + k, bins),
                             mad(ny, blend(s, dy + k, t, dy + k + bins), nz * blend(s, dz + k, t, dz + k + bins)));
        const F q = moment / max(mass, F(1e-12f));
        const F half = min(max(moment * mad(F(2) * q, q, F(1.5f)), F(0) - mass), mass);
        store_histogram(mass + half + load_row<F>(b.near_bins + k), histograms + k);
        store_histogram(mass - half + load_row<F>(b.near_bins + bins + k), histograms + bins + k);
    }
}

/// Every `step`th cell of a fine row whose plane is interpolated; `normals` three numbers a cell of the row.
template <class F>
CHIARO_INLINE void fast_cells(const FastBlock& b, int fine_y, int fine_z, int count, int step, const float* normals,
                              std::int16_t* histograms) {
    fast_row<F>(b, fine_y);
    const std::uint32_t* row = b.tile + b.fine_first + std::int64_t(b.fine_first + fine_y) * b.tile_row +
                               std::int64_t(b.fine_first + fine_z) * b.tile_slice;
    for (int x = 0; x < count; x += step, histograms += 2 * b.bins) {
        for (int k = 0; k < 2 * b.bins; ++k) b.near_bins[k] = 0;
        const float* n = normals + 3 * x;
        count_near(b, row + x, n, b.near_bins, b.near_bins + b.bins);
        finish_cell<F>(b, x, n, histograms);
    }
}

}  // namespace chiaro::kernel

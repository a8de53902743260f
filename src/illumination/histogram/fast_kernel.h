// Histograms of a block of cells by sums over boxes, in vectors of packed bins, a bin to a lane. Far cells are summed
// as coarse ones of 2³, exactly in integers; near ones are counted one by one.
#pragma once
#include "illumination/histogram/codebook_view.h"
#include "illumination/histogram/fast_block.h"
#include "kernel/row.h"

namespace chiaro::kernel {

/// Adds a cell, `times` of them, to a column: it has up to two neighbouring packed bins.
CHIARO_INLINE void add_cell(std::uint32_t code, std::int32_t times, std::int32_t* column) {
    std::int32_t* const bin = column + (code & 0xff);
    bin[0] += times * std::int32_t(code >> 8 & 0x1ff);
    if (code >> 17) bin[1] += times * std::int32_t(code >> 17);
}
/// Adds (or takes away) a coarse cell, which is eight cells; where nothing is, these are all the same.
template <int sign>
CHIARO_INLINE void add_coarse_cell(const FastBlock& b, int x, int y, int z, std::int32_t* column) {
    const std::uint32_t* cell = b.tile + 2 * x + std::int64_t(2 * y) * b.tile_row + std::int64_t(2 * z) * b.tile_slice;
    std::uint32_t code[8], differ = 0;
    for (int i = 0; i < 8; ++i) {
        code[i] = cell[(i & 1) + (i >> 1 & 1) * b.tile_row + (i >> 2) * b.tile_slice];
        differ |= code[i] ^ code[0];
    }
    if (differ == 0) return add_cell(code[0], 8 * sign, column);
    for (int i = 0; i < 8; ++i) add_cell(code[i], sign, column);
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

/// Columns of coarse cells that several boxes share: how far they reach around the nodes.
struct Columns {
    std::int32_t reach_x, reach_y, half_z;
    CHIARO_INLINE int width() const { return FastBlock::nodes + 2 * reach_x; }
    CHIARO_INLINE int height() const { return FastBlock::nodes + 2 * reach_y; }
};

/// Adds the coarse cell at depth `z` of the columns to one.
template <int sign>
CHIARO_INLINE void add_to_column(const FastBlock& b, const Columns& columns, int x, int y, int z,
                                 std::int32_t* column) {
    add_coarse_cell<sign>(b, b.reach - columns.reach_x + x, b.reach - columns.reach_y + y, b.reach - columns.half_z + z,
                          column);
}
/// A column around plane `z` of nodes, from nothing.
CHIARO_INLINE void fill_column(const FastBlock& b, const Columns& columns, int x, int y, int z, std::int32_t* column) {
    for (int k = 0; k < b.bins; ++k) column[k] = 0;
    for (int i = 0; i <= 2 * columns.half_z; ++i) add_to_column<1>(b, columns, x, y, z + i, column);
}
/// On to plane `z` from the one before.
CHIARO_INLINE void move_column(const FastBlock& b, const Columns& columns, int x, int y, int z, std::int32_t* column) {
    add_to_column<-1>(b, columns, x, y, z - 1, column);
    add_to_column<1>(b, columns, x, y, z + 2 * columns.half_z, column);
}

/// Sums of the columns of a plane along x for a row of nodes, of the bins from `g` on.
template <class F>
CHIARO_INLINE void sum_row(const Columns& columns, const FastBox& box, int bins, int y, int g, const std::int32_t* from,
                           std::int32_t* rows) {
    const int column = (y + columns.reach_y - box.half_y) * columns.width() + columns.reach_x - box.half_x;
    std::int32_t* const out = rows + y * FastBlock::nodes * bins + g;
    running_sums<F>(from + column * bins + g, bins, FastBlock::nodes, box.half_x,
                    [&](int i, Int<F> sum) CHIARO_INLINE_LAMBDA { store_counts(out + i * bins, sum); });
}

/// A box's sums, weighted into both filters.
template <class F>
CHIARO_INLINE void add_weighted(F mass, F blur, Int<F> sum, float* to_mass, float* to_blur) {
    store_row(to_mass, mad(mass, to_float(sum), load_row<F>(to_mass)));
    store_row(to_blur, mad(blur, to_float(sum), load_row<F>(to_blur)));
}
/// Of a row of nodes, whose vectors begin at `from` and go to `at`.
template <class F>
CHIARO_INLINE void add_row(const FastBlock& b, const FastBox& box, const std::int32_t* from, int at) {
    const F mass(box.mass), blur(box.blur);
    float *const to_mass = b.mass + at, *const to_blur = b.blur + at;
    const int bins = b.bins;
    running_sums<F>(from, bins, FastBlock::nodes, box.half_x, [&](int i, Int<F> sum) CHIARO_INLINE_LAMBDA {
        add_weighted(mass, blur, sum, to_mass + i * bins, to_blur + i * bins);
    });
}

/// sums += ahead - behind
template <class F>
CHIARO_INLINE void move_sums(const std::int32_t* ahead, const std::int32_t* behind, int n, std::int32_t* sums) {
    for (int i = 0; i < n; i += LaneTraits<F>::count)
        store_counts(sums + i, load_counts<F>(sums + i) + load_counts<F>(ahead + i) - load_counts<F>(behind + i));
}

/// One plane of nodes: sums over boxes [from, end) of the columns, along y and then along x. Row by row, so that what
/// all boxes add to stays in the first cache; `b.rows` holds a row of sums for each box.
template <class F>
CHIARO_INLINE void add_plane(const FastBlock& b, const Columns& columns, int from, int end, int z) {
    static_assert(FastBlock::max_boxes <= FastBlock::nodes);  // the room of `rows`
    const int bins = b.bins, width = columns.width() * bins;
    const auto row_of_columns = [&](int y) CHIARO_INLINE_LAMBDA { return b.columns + y * width; };
    for (int i = 0; i < (end - from) * width; ++i) b.rows[i] = 0;
    for (int n = from; n < end; ++n)
        for (int y = -b.box[n].half_y; y <= b.box[n].half_y; ++y)
            for (int i = 0; i < width; ++i) b.rows[(n - from) * width + i] += row_of_columns(columns.reach_y + y)[i];
    for (int y = 0; y < FastBlock::nodes; ++y)
        for (int n = from; n < end; ++n) {
            const FastBox box = b.box[n];
            std::int32_t* const sums = b.rows + (n - from) * width;
            for (int g = 0; g < bins; g += LaneTraits<F>::count)
                add_row<F>(b, box, sums + (columns.reach_x - box.half_x) * bins + g,
                           (z * FastBlock::nodes + y) * FastBlock::nodes * bins + g);
            const int here = columns.reach_y + y;
            if (y + 1 < FastBlock::nodes)
                move_sums<F>(row_of_columns(here + 1 + box.half_y), row_of_columns(here - box.half_y), width, sums);
        }
}

/// use(columns, from, end) for the boxes of each half_z, which lie next to each other.
template <class Use>
CHIARO_INLINE void for_columns(const FastBlock& b, Use&& use) {
    for (int from = 0, end = 0; from < b.boxes; from = end) {
        Columns columns{0, 0, b.box[from].half_z};
        for (; end < b.boxes && b.box[end].half_z == columns.half_z; ++end) {
            columns.reach_x = max(columns.reach_x, b.box[end].half_x);
            columns.reach_y = max(columns.reach_y, b.box[end].half_y);
        }
        use(columns, from, end);
    }
}

/// Both filters at all nodes of a block: M0 of the far cells, and P whose gradient is their M1.
template <class F>
CHIARO_INLINE void fast_sums(const FastBlock& b) {
    constexpr int nodes = FastBlock::nodes;
    for (int i = 0; i < nodes * nodes * nodes * b.bins; ++i) b.mass[i] = 0, b.blur[i] = 0;
    for_columns(b, [&](const Columns& columns, int from, int end) CHIARO_INLINE_LAMBDA {
        for (int z = 0; z < nodes; ++z) {
            std::int32_t* column = b.columns;
            for (int y = 0; y < columns.height(); ++y)
                for (int x = 0; x < columns.width(); ++x, column += b.bins)
                    z == 0 ? fill_column(b, columns, x, y, z, column) : move_column(b, columns, x, y, z, column);
            add_plane<F>(b, columns, from, end, z);
        }
    });
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

/// Numbers `i` on of a plane of fine cells: M0, P and its difference along z, interpolated between planes of nodes.
template <class F>
CHIARO_INLINE void interpolate_planes(const FastBlock& b, Between z, std::int64_t i, float* out) {
    const std::int64_t plane = std::int64_t(FastBlock::nodes) * FastBlock::nodes * b.bins;
    const float *const m = b.mass + z.node * plane + i, *const p = b.blur + z.node * plane + i;
    const F t(z.next), s(1 - z.next);
    store_row(out + i, blend(s, m, t, m + plane));
    store_row(out + plane + i, blend(s, p, t, p + plane));
    store_row(out + 2 * plane + i, blend_slope(s, t, p, plane));
}

/// The same for a row of the plane; differences along y and z.
template <class F>
CHIARO_INLINE void interpolate_rows(int bins, const float* from, Between y, std::int64_t i, float* line) {
    const std::int64_t row = std::int64_t(FastBlock::nodes) * bins, plane = FastBlock::nodes * row;
    const float *const m = from + y.node * row + i, *const p = m + plane, *const dz = p + plane;
    const F t(y.next), s(1 - y.next);
    store_row(line + i, blend(s, m, t, m + row));
    store_row(line + row + i, blend(s, p, t, p + row));
    store_row(line + 2 * row + i, blend_slope(s, t, p, row));
    store_row(line + 3 * row + i, blend(s, dz, t, dz + row));
}

template <class F>
CHIARO_INLINE void fast_plane(const FastBlock& b, int fine_z) {
    const std::int64_t plane = std::int64_t(FastBlock::nodes) * FastBlock::nodes * b.bins;
    for (std::int64_t i = 0; i < plane; i += LaneTraits<F>::count)
        interpolate_planes<F>(b, between(fine_z), i, b.plane);
}

/// Counts the cells near one cell by their true side of it: of each packed bin forward, then backward. First what each
/// adds, then the adding: one after the other they would wait for each other.
template <class F>
CHIARO_INLINE void count_near(const FastBlock& b, const std::uint32_t* cell, const float* n, float* near) {
    using Four = typename NumbersOf<F>::Four;
    for (int k = 0; k < FastBlock::near_numbers(b.bins); ++k) near[k] = 0;
    float forward[NearCells::most], shares[NearCells::most][4];
    const NearCells& c = b.near;
    for (int i = 0; i < NearCells::most; ++i) {
        const float ahead = mad(c.x[i], n[0], mad(c.y[i], n[1], c.z[i] * n[2]));
        forward[i] = c.weight[i] * (ahead > 0 ? 1.0f : ahead < 0 ? 0.0f : 0.5f);
    }
    for (int i = 0; i < c.count; ++i) {
        const std::uint32_t code = cell[c.distance[i]];
        const float f = forward[i], r = c.weight[i] - f, first = float(code >> 8 & 0x1ff), second = float(code >> 17);
        shares[i][0] = first * f, shares[i][1] = first * r, shares[i][2] = second * f, shares[i][3] = second * r;
    }
    float* bins = near;
    Four there(0), more;  // neighbours share a bin more often than not: it stays in a register
    for (int i = 0; i < c.count; ++i) {
        if (float* const here = near + 2 * (cell[c.distance[i]] & 0xff); here != bins) {
            store(there, bins);
            load(here, there);
            bins = here;
        }
        load(shares[i], more);
        there = there + more;
    }
    store(there, bins);
}

template <class F>
CHIARO_INLINE void store_histogram(F share, std::int16_t* to) {
    store_whole(truncate(min(max(share, F(0)), F(1)) * F(float(packed_one)) + F(0.5f)),
                reinterpret_cast<std::uint16_t*>(to));
}

/// The bins `k` on of both histograms of one cell of a row that is interpolated: M0 ± M1 (3/2 + 2 q²), q = n · M1 / M0,
/// and what was counted near it; packed_one for 1. `n` is ∇f of length 1, or 0.
template <class F>
CHIARO_INLINE void finish_bins(const FastBlock& b, const float* line, Between x, const float* n, const float* near,
                               int k, std::int16_t* histograms) {
    const std::int64_t row = std::int64_t(FastBlock::nodes) * b.bins;
    const int bins = b.bins;
    const F t(x.next), s(1 - x.next);
    const float *const m = line + x.node * bins + k, *const p = m + row, *const dy = p + row, *const dz = dy + row;
    const F mass = max(blend(s, m, t, m + bins), F(0));
    const F moment = mad(F(n[0]), blend_slope(s, t, p, bins),
                         mad(F(n[1]), blend(s, dy, t, dy + bins), F(n[2]) * blend(s, dz, t, dz + bins)));
    const F q = moment / max(mass, F(1e-12f));
    const F half = min(max(moment * mad(F(2) * q, q, F(1.5f)), F(0) - mass), mass);
    F forward, backward;
    load_interleaved(near + 2 * k, forward, backward);
    store_histogram(mass + half + forward, histograms + k);
    store_histogram(mass - half + backward, histograms + bins + k);
}

CHIARO_INLINE const std::uint32_t* in_tile(const FastBlock& b, int fine_x, int fine_y, int fine_z) {
    return b.tile + b.fine_first + fine_x + std::int64_t(b.fine_first + fine_y) * b.tile_row +
           std::int64_t(b.fine_first + fine_z) * b.tile_slice;
}

/// Every `step`th cell of a fine row whose plane is interpolated; `normals` three numbers a cell of the row.
template <class F>
CHIARO_INLINE void fast_cells(const FastBlock& b, int fine_y, int fine_z, int count, int step, const float* normals,
                              std::int16_t* histograms) {
    constexpr int lanes = LaneTraits<F>::count;
    for (std::int64_t i = 0; i < std::int64_t(FastBlock::nodes) * b.bins; i += lanes)
        interpolate_rows<F>(b.bins, b.plane, between(fine_y), i, b.line);
    for (int x = 0; x < count; x += step, histograms += 2 * b.bins) {
        const float* n = normals + 3 * x;
        count_near<F>(b, in_tile(b, x, fine_y, fine_z), n, b.near_bins);
        for (int k = 0; k < b.bins; k += lanes) finish_bins<F>(b, b.line, between(x), n, b.near_bins, k, histograms);
    }
}

}  // namespace chiaro::kernel

// What the fused sweep keeps of a block while it works on it: its opacities and their means over octants, and what the
// coarser grid says around it.
//
// Octant s of cell p at level l is the cube between p and p + s 2^(l-1) (cells); its mean O_l,s is one look-up:
// repeated halving gives means over windows that begin at a cell, T_1[i] over i..i+1 and T_2[i] over i..i+2 with half
// weight at both ends, per axis; then O_l,s(p) = T_l[p] on the side that ascends and T_l[p - 2^(l-1)] on the other. The
// paper's cube A_l about p is the mean of the eight O_l,s, and A_0 = O_0 = α.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

/// A block of cells and the two around it that its levels reach.
struct SpaoTile {
    static constexpr int edge = 32, halo = 2, row = edge + 2 * halo, slice = row * row, size = slice * row;
    static constexpr int shells = 2;  ///< of the finest grid; each coarser one has one
    static constexpr int piece = 16;  ///< cells of a row that are computed together
    std::uint16_t opacity[size + row];
    std::uint16_t mean[shells][size + row];  ///< T_1, T_2; on a coarser grid only means over two cells, in the second
};

template <int distance>
CHIARO_INLINE void halve(const std::uint16_t* from, std::uint16_t* to) {
    for (int i = 0; i < SpaoTile::size - distance; ++i) to[i] = mean_of(from[i], from[i + distance]);
}
template <int distance>
CHIARO_INLINE void halve(std::uint16_t* values) {
    for (int i = 0; i < SpaoTile::size - distance; ++i) values[i] = mean_of(values[i], values[i + distance]);
}
CHIARO_INLINE void halve_all_axes(const std::uint16_t* from, std::uint16_t* to) {
    halve<1>(from, to);
    halve<SpaoTile::row>(to);
    halve<SpaoTile::slice>(to);
}
/// The same for one cell: the mean of the 8 from it on.
CHIARO_INLINE std::uint16_t halved(const std::uint16_t* from) {
    const auto along_x = [&](int i) CHIARO_INLINE_LAMBDA { return mean_of(from[i], from[i + 1]); };
    const auto along_y = [&](int i) CHIARO_INLINE_LAMBDA { return mean_of(along_x(i), along_x(i + SpaoTile::row)); };
    return mean_of(along_y(0), along_y(SpaoTile::slice));
}
/// On the finest grid octants begin in the middle of their cell: half weight at both ends.
CHIARO_INLINE void find_means_from_cells(SpaoTile& tile) {
    halve_all_axes(tile.opacity, tile.mean[0]);
    halve_all_axes(tile.mean[0], tile.mean[1]);
}
/// On a coarser one at a cell's corner, the low one: whole cells, one and two. No cell is cut, nothing is smeared.
CHIARO_INLINE void find_means_from_corners(SpaoTile& tile) { halve_all_axes(tile.opacity, tile.mean[1]); }

/// Level l as octants look it up; a corner's innermost octant is the cell itself.
template <bool at_cells>
CHIARO_INLINE const std::uint16_t* level_of(const SpaoTile& tile, int level) {
    return !at_cells && level == 1 ? tile.opacity : tile.mean[level - 1];
}

/// Where octant s looks up level l, from the cell's own place: s has a bit for each axis that ascends.
CHIARO_INLINE int octant_offset(int level, int s) {
    if (level == 0) return 0;
    const int back = 1 << (level - 1);
    return -((s & 1 ? 0 : back) + (s & 2 ? 0 : back * SpaoTile::row) + (s & 4 ? 0 : back * SpaoTile::slice));
}

/// The coarser grid's corners from the first of a block on: by octant, weighted where there are weights. The last row
/// and slice that exist are told; no cell asks beyond.
struct CoarseRows {
    const std::uint16_t *open[8], *weight;
    std::int64_t row, slice, weight_row, weight_slice;
    std::int32_t last_row, last_slice;
};

/// Between two corners of the coarser grid: a cell's centre lies a quarter of the way from the nearer one, a corner of
/// the finer grid on the first or half-way.
template <bool at_cells, class S>
CHIARO_INLINE S between(S low, S high, bool is_odd) {
    if (at_cells) return mean_of(mean_of(low, high), is_odd ? high : low);
    return is_odd ? mean_of(low, high) : low;
}
/// The same of rows: what is chosen is where to read, not what was read.
template <bool at_cells, class F>
CHIARO_INLINE Shorts<F> between_rows(const std::uint16_t* low, const std::uint16_t* high, bool is_odd) {
    if (!at_cells && !is_odd) return load_shorts<F>(low);
    const Shorts<F> middle = mean_of(load_shorts<F>(low), load_shorts<F>(high));
    return at_cells ? mean_of(middle, load_shorts<F>(is_odd ? high : low)) : middle;
}

/// The coarser grid at one slice of a block, as fine as the block along x.
struct CoarsePlanes {
    static constexpr int row = SpaoTile::edge, rows = row / 2 + 1;
    std::uint16_t open[8][rows * row], weight[rows * row];

    /// Of slice z, what `ny` rows of the block read.
    template <bool at_cells, class F>
    CHIARO_INLINE void load(const CoarseRows& from, int octants, int z, int ny) {
        const int low = z >> 1, high = min(low + 1, from.last_slice), last = min((ny + 1) / 2, from.last_row);
        const auto blend = [&](const std::uint16_t* corners, std::int64_t slice, std::uint16_t* to)
                               CHIARO_INLINE_LAMBDA {
                                   blend_row<at_cells, F>(corners + low * slice, corners + high * slice, z & 1, to);
                               };
        for (int y = 0; y <= last; ++y) {
            for (int s = 0; s < octants; ++s) blend(from.open[s] + y * from.row, from.slice, open[s] + y * row);
            if (octants > 1) blend(from.weight + y * from.weight_row, from.weight_slice, weight + y * row);
        }
    }

    /// Of octant s, or the weights, at cells of a row.
    template <bool at_cells, class F>
    CHIARO_INLINE F open_at(int s, int x, int y) const {
        return blend<at_cells, F>(open[s], x, y);
    }
    template <bool at_cells, class F>
    CHIARO_INLINE F weight_at(int x, int y) const {
        return blend<at_cells, F>(weight, x, y);
    }

private:
    /// 17 corners to 32 cells.
    template <bool at_cells, class F>
    static CHIARO_INLINE void blend_row(const std::uint16_t* low, const std::uint16_t* high, bool is_odd,
                                        std::uint16_t* to) {
        for (int i = 0; i < row / 2; i += LaneTraits<F>::count) {
            const Shorts<F> a = between_rows<at_cells, F>(low + i, high + i, is_odd),
                            b = between_rows<at_cells, F>(low + i + 1, high + i + 1, is_odd);
            store_interleaved(between<at_cells>(a, b, false), between<at_cells>(a, b, true), to + 2 * i);
        }
    }
    template <bool at_cells, class F>
    static CHIARO_INLINE F blend(const std::uint16_t* plane, int x, int y) {
        const std::uint16_t* low = plane + (y >> 1) * row + x;
        return to_float(between_rows<at_cells, F>(low, low + row, y & 1));
    }
};

/// The same of one cell.
struct CoarseAround {
    float open[8], weight;

    template <bool at_cells, class F>
    CHIARO_INLINE F open_at(int s, int, int) const {
        return open[s];
    }
    template <bool at_cells, class F>
    CHIARO_INLINE F weight_at(int, int) const {
        return weight;
    }
};

/// What is known at a corner, one load or store.
struct alignas(16) EightOctants {
    std::uint16_t of[8];
};

/// A coarser grid's corners, x fastest, from which each cell takes what lies around it: along z, x and y, as planes are
/// made and read.
struct CoarseCorners {
    const EightOctants* octants;  ///< null: one number each, in `cubes`
    const std::uint16_t *cubes, *weight;
    std::int32_t count[3];

    template <bool at_cells>
    CHIARO_INLINE CoarseAround around(int x, int y, int z) const {
        std::int64_t at[8];
        for (int c = 0; c < 8; ++c) at[c] = corner((x >> 1) + (c & 1), (y >> 1) + (c >> 1 & 1), (z >> 1) + (c >> 2));
        const auto blend = [&](const auto& value) CHIARO_INLINE_LAMBDA {
            const auto along_z = [&](int c)
                                     CHIARO_INLINE_LAMBDA { return between<at_cells>(value(c), value(c | 4), z & 1); };
            const auto along_x = [&](int c) CHIARO_INLINE_LAMBDA {
                return between<at_cells>(along_z(c), along_z(c | 1), x & 1);
            };
            return to_float(between<at_cells>(along_x(0), along_x(2), y & 1));
        };
        CoarseAround found{};
        if (!octants) {
            found.open[0] = blend([&](int c) CHIARO_INLINE_LAMBDA { return cubes[at[c]]; });
            return found;
        }
        EightOctants corners[8];
        for (int c = 0; c < 8; ++c) corners[c] = octants[at[c]];
        for (int s = 0; s < 8; ++s) found.open[s] = blend([&](int c) CHIARO_INLINE_LAMBDA { return corners[c].of[s]; });
        found.weight = blend([&](int c) CHIARO_INLINE_LAMBDA { return weight[at[c]]; });
        return found;
    }

private:
    /// Past the last corner lies no cell that asks.
    CHIARO_INLINE std::int64_t corner(int i, int j, int k) const {
        i = min(i, count[0] - 1), j = min(j, count[1] - 1), k = min(k, count[2] - 1);
        return (std::int64_t(k) * count[1] + j) * count[0] + i;
    }
};

}  // namespace chiaro::kernel

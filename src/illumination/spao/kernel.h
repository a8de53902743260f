// The fused sweep over one block: means over octant cubes, the product over shells, and the sum over octants, for one
// cell or sixteen of a row at a time.
//
// Octant s of cell p at level l is the cube between p and p + s 2^(l-1) (cells); its mean O_l,s is one look-up:
// repeated halving gives means over windows that begin at a cell, T_1[i] over i..i+1 and T_2[i] over i..i+2 with half
// weight at both ends, per axis; then O_l,s(p) = T_l[p] on the side that ascends and T_l[p - 2^(l-1)] on the other. The
// paper's cube A_l about p is the mean of the eight O_l,s, and A_0 = O_0 = α.
#pragma once
#include "illumination/cells/kernel.h"
#include "kernel/math.h"
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

/// What the coarser grid says at the corners of its cells, of half the block and one corner more.
struct CoarseTile {
    static constexpr int edge = SpaoTile::edge / 2 + 1, slice = edge * edge, size = edge * slice;
    std::uint16_t open[8][size + slice + 16];  ///< by octant; weighted where there are weights
    std::uint16_t weight[size + slice + 16];
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

/// 1 - S_l, S_l = (8 O_(l+1) - O_l) / 7: the matter in the shell alone.
template <class F>
CHIARO_INLINE F open_share(F inner, F outer) {
    constexpr float seventh = 1 / (7 * 65535.0f);
    return min(max(F(1) + F(seventh) * inner - F(8 * seventh) * outer, F(0)), F(1));
}

enum class SpaoProduct : std::int32_t { paper, thick, corrected };

/// Π (1 - S_l)^(t_l), from the outermost shell inwards: each shell is 2 times as thick as the one inside it, so what is
/// there so far is squared (raised to 2^0.75, left alone) before the next one joins.
template <SpaoProduct product, class F>
CHIARO_INLINE F join(F outer_shells, F open) {
    if constexpr (product == SpaoProduct::corrected) return outer_shells * outer_shells * open;
    if constexpr (product == SpaoProduct::thick) return pow(outer_shells, F(1.681792831f)) * open;
    return outer_shells * open;
}
/// The innermost shell is half a cell thick.
template <SpaoProduct product, class F>
CHIARO_INLINE F finish(F shells) {
    if constexpr (product == SpaoProduct::corrected) return sqrt(shells);
    if constexpr (product == SpaoProduct::thick) return pow(shells, F(0.594603558f));
    return shells;
}

/// Levels O_0, O_1 and O_2 of one octant, where the cell looks them up.
struct OctantLevels {
    const std::uint16_t* at[SpaoTile::shells + 1];
};

/// Shells 1 and 0 joined to the product of those further out.
template <SpaoProduct product, class F>
CHIARO_INLINE F join_shells(const OctantLevels& o, bool has_second, bool has_first, F further_out) {
    F r = further_out, middle = load_row<F>(o.at[1]);
    if (has_second) r = join<product>(r, open_share(middle, load_row<F>(o.at[2])));
    if (has_first) r = join<product>(r, open_share(load_row<F>(o.at[0]), middle));
    return r;
}

/// One block's work; what is the same for all its rows.
struct SpaoBlock {
    const SpaoTile* tile;
    const CoarseTile* coarse;  ///< null: nothing lies further out
    SpaoProduct product;
    std::int32_t last;  ///< the last shell that this grid answers for
    float normal_factor;
    std::int32_t octants;  ///< 8, or 1 for the products over whole cubes
    bool weighs;           ///< whether the coarser grid's corners are weighted
    /// Of the block's corners on a coarser grid, as far apart as the results: what they are worth to their neighbours.
    /// A corner inside opaque matter sees nothing, and must not darken the open cells beside it. Null: all the same.
    const std::uint16_t* weight;
};

/// Between two corners of the coarser grid: a cell's centre lies a quarter of the way from the nearer one, a corner of
/// the finer grid on the first or half-way.
template <bool at_cells, class S>
CHIARO_INLINE S between(S low, S high, bool is_odd) {
    if (at_cells) return mean_of(mean_of(low, high), is_odd ? high : low);
    return is_odd ? mean_of(low, high) : low;
}

/// The coarser grid at one slice of a block, as fine as the block along x.
struct CoarsePlanes {
    static constexpr int row = SpaoTile::edge;
    std::uint16_t open[8][CoarseTile::edge * row], weight[CoarseTile::edge * row];
};

template <bool at_cells, class F>
CHIARO_INLINE void coarse_plane(const std::uint16_t* corners, int z, std::uint16_t* plane) {
    constexpr int lanes = LaneTraits<F>::count, n = CoarseTile::edge;
    std::uint16_t blend[CoarseTile::slice + lanes];
    const std::uint16_t* low = corners + (z >> 1) * CoarseTile::slice;
    for (int i = 0; i < CoarseTile::slice; i += lanes)
        store(between<at_cells>(load_shorts<F>(low + i), load_shorts<F>(low + i + CoarseTile::slice), z & 1),
              blend + i);
    for (int y = 0; y < n; ++y)
        for (int i = 0; i < n - 1; i += lanes) {
            const Shorts<F> a = load_shorts<F>(blend + y * n + i), b = load_shorts<F>(blend + y * n + i + 1);
            store_interleaved(between<at_cells>(a, b, false), between<at_cells>(a, b, true),
                              plane + y * CoarsePlanes::row + 2 * i);
        }
}

/// Cells of a row of that plane.
template <bool at_cells, class F>
CHIARO_INLINE F coarse_row(const std::uint16_t* plane, int x, int y) {
    const std::uint16_t* low = plane + (y >> 1) * CoarsePlanes::row + x;
    return to_float(between<at_cells>(load_shorts<F>(low), load_shorts<F>(low + CoarsePlanes::row), y & 1));
}

/// A = Σ w_s r_s, w_s = (1 - q)/8 + q max(0, n·s)/Σ max(0, n·s); the last sum is 2 max(2a, a + b + c) for the normal's
/// components a >= b, c by magnitude. `all` is Σ r_s, `outwards` Σ max(0, n·s) r_s.
template <class F>
CHIARO_INLINE F weigh_octants(F q, Vec3<F> n, F all, F outwards) {
    const F a = abs(n.x), b = abs(n.y), c = abs(n.z);
    const F total = F(2) * max(a + b + c, F(2) * max(a, max(b, c)));
    return (F(1) - q) * F(0.125f) * all + q * (outwards / max(total, F(1e-9f)));
}

/// A piece of a row: where it begins in the tile and the block, and what lies further out.
struct SpaoPiece {
    std::int32_t at, x, y;
    const CoarsePlanes* planes;
};

/// One over what the weights of the corners around come to.
template <bool at_cells, class F>
CHIARO_INLINE F further_scale(const SpaoBlock& b, const SpaoPiece& p, int x) {
    return b.weighs ? F(1) / coarse_row<at_cells, F>(p.planes->weight, p.x + x, p.y) : F(1.0f / 65535);
}
/// The product of the shells further out of octant s: the weighted mean over the corners around.
template <bool at_cells, class F>
CHIARO_INLINE F further_out(const SpaoBlock& b, const SpaoPiece& p, int x, int s, F scale) {
    return b.coarse ? min(coarse_row<at_cells, F>(p.planes->open[s], p.x + x, p.y) * scale, F(1)) : F(1);
}

template <bool at_cells>
CHIARO_INLINE OctantLevels octant_levels(const SpaoTile& tile, int at, int s) {
    return {{tile.opacity + at, level_of<at_cells>(tile, 1) + at + octant_offset(1, s),
             level_of<at_cells>(tile, 2) + at + octant_offset(2, s)}};
}

/// -(α(i + 1) - α(i - 1)) per axis.
template <class F>
CHIARO_INLINE Vec3<F> step_down_row(const std::uint16_t* opacity) {
    const auto along = [&](int d) CHIARO_INLINE_LAMBDA {
        return (load_row<F>(opacity - d) - load_row<F>(opacity + d)) * F(1.0f / 65535);
    };
    return {along(1), along(SpaoTile::row), along(SpaoTile::slice)};
}

/// On the finest grid out[0] receives the accessibility, on a coarser one out[s] the product so far of octant s, times
/// the corners' weights.
template <bool at_cells, class F>
CHIARO_INLINE void octants_piece(const SpaoBlock& b, const SpaoPiece& p, const std::uint16_t* weight,
                                 std::uint16_t (*out)[SpaoTile::piece]) {
    for (int x = 0; x < SpaoTile::piece; x += LaneTraits<F>::count) {
        const F scale = further_scale<at_cells, F>(b, p, x);
        const Vec3<F> n = step_down_row<F>(b.tile->opacity + p.at + x);
        F all(0), outwards(0);
        for (int s = 0; s < 8; ++s) {
            F r = join_shells<SpaoProduct::corrected>(octant_levels<at_cells>(*b.tile, p.at + x, s), b.last >= 1,
                                                      at_cells, further_out<at_cells>(b, p, x, s, scale));
            if constexpr (at_cells) {
                const F side = (s & 1 ? n.x : F(0) - n.x) + (s & 2 ? n.y : F(0) - n.y) + (s & 4 ? n.z : F(0) - n.z);
                r = finish<SpaoProduct::corrected>(r);
                all = all + r;
                outwards = outwards + max(side, F(0)) * r;
            } else {
                store_whole(truncate(r * load_row<F>(weight + x) + F(0.5f)), out[s] + x);
            }
        }
        if constexpr (at_cells)
            store_shares(min(weigh_octants(outward_share(n, b.normal_factor), n, all, outwards), F(1)), out[0] + x);
    }
}

/// Means of the eight octants: the paper's cubes.
CHIARO_INLINE void cube_piece(const std::uint16_t* mean, int level, std::uint16_t* piece) {
    for (int x = 0; x < SpaoTile::piece; ++x) {
        const auto at = [&](int s) CHIARO_INLINE_LAMBDA { return mean[x + octant_offset(level, s)]; };
        piece[x] = mean_of(mean_of(mean_of(at(0), at(1)), mean_of(at(2), at(3))),
                           mean_of(mean_of(at(4), at(5)), mean_of(at(6), at(7))));
    }
}

/// The same for the products over whole cubes, in out[0].
template <SpaoProduct product, bool at_cells, class F>
CHIARO_INLINE void cubes_piece(const SpaoBlock& b, const SpaoPiece& p, std::uint16_t (*out)[SpaoTile::piece]) {
    std::uint16_t cubes[SpaoTile::shells][SpaoTile::piece];
    for (int l = 1; l <= SpaoTile::shells; ++l) cube_piece(level_of<at_cells>(*b.tile, l) + p.at, l, cubes[l - 1]);
    for (int x = 0; x < SpaoTile::piece; x += LaneTraits<F>::count) {
        const OctantLevels levels{{b.tile->opacity + p.at + x, cubes[0] + x, cubes[1] + x}};
        F r = join_shells<product>(levels, b.last >= 1, at_cells, further_out<at_cells>(b, p, x, 0, F(1.0f / 65535)));
        if constexpr (at_cells) r = finish<product>(r);
        store_shares(r, out[0] + x);
    }
}

/// Where a block's results go: up to 8 arrays of the same layout, how much of the block lies in them, and which pieces
/// are asked for: 16 × 4 × 4 cells each, bit x of [z][y].
struct SpaoOutput {
    std::uint16_t* at[8];
    std::int64_t row, slice;
    std::int32_t nx, ny, nz;
    const std::uint8_t (*pieces)[SpaoTile::edge / 4];
};

template <bool at_cells, class F>
CHIARO_INLINE void spao_piece(const SpaoBlock& b, const SpaoPiece& p, const SpaoOutput& to, std::int64_t at) {
    std::uint16_t out[8][SpaoTile::piece];
    if (b.product == SpaoProduct::corrected)
        octants_piece<at_cells, F>(b, p, b.weight ? b.weight + at : nullptr, out);
    else if (b.product == SpaoProduct::thick)
        cubes_piece<SpaoProduct::thick, at_cells, F>(b, p, out);
    else
        cubes_piece<SpaoProduct::paper, at_cells, F>(b, p, out);
    const std::int32_t count = min(to.nx - p.x, SpaoTile::piece);
    for (std::int32_t s = 0; s < (at_cells ? 1 : b.octants); ++s)
        if (count == SpaoTile::piece)
            __builtin_memcpy(to.at[s] + at, out[s], sizeof out[s]);
        else
            for (std::int32_t x = 0; x < count; ++x) to.at[s][at + x] = out[s][x];
}

template <bool at_cells, class F>
CHIARO_INLINE void spao_block(const SpaoBlock& b, const SpaoOutput& to) {
    constexpr int halo = SpaoTile::halo;
    CoarsePlanes planes;
    for (std::int32_t z = 0; z < to.nz; ++z) {
        for (std::int32_t s = 0; b.coarse && s < b.octants; ++s)
            coarse_plane<at_cells, F>(b.coarse->open[s], z, planes.open[s]);
        if (b.weighs) coarse_plane<at_cells, F>(b.coarse->weight, z, planes.weight);
        for (std::int32_t y = 0; y < to.ny; ++y)
            for (std::int32_t x = 0; x < to.nx; x += SpaoTile::piece) {
                if (!(to.pieces[z / 4][y / 4] >> (x / SpaoTile::piece) & 1)) continue;
                const std::int32_t in_tile = (z + halo) * SpaoTile::slice + (y + halo) * SpaoTile::row + halo + x;
                spao_piece<at_cells, F>(b, {in_tile, x, y, &planes}, to, z * to.slice + y * to.row + x);
            }
    }
}

}  // namespace chiaro::kernel

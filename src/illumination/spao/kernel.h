// The fused sweep over one block, for one cell or sixteen of a row at a time.
#pragma once
#include "illumination/cells/block_place.h"
#include "illumination/cells/outward.h"
#include "illumination/spao/product.h"
#include "illumination/spao/tile.h"

namespace chiaro::kernel {

/// Levels O_0, O_1 and O_2 of one octant, where the cell looks them up.
struct OctantLevels {
    const std::uint16_t* at[SpaoTile::shells + 1];
};

/// The shells of cubes joined to the product of those further out.
template <SpaoProduct product, class F>
CHIARO_INLINE F join_cubes(const OctantLevels& o, bool has_second, bool has_first, F further_out) {
    F r = further_out, middle = load_row<F>(o.at[1]);
    if (has_second) r = join<product>(r, open_share(middle, load_row<F>(o.at[2])));
    if (has_first) r = join<product>(r, open_share(load_row<F>(o.at[0]), middle));
    return r;
}

/// The shells of an octant likewise. On the coarser grids a cell's opacity is what does not cross it, thickness and
/// all: no exponent is left but that of shell 0, which is half a cell thick. (Powers of mean opacities take matter as
/// spread evenly; where it lies in clumps, as bone and twigs do, they close the ways between.)
template <class F>
CHIARO_INLINE F join_octant(const OctantLevels& o, bool has_second, bool has_first, F further_out) {
    F r = further_out, middle = load_row<F>(o.at[1]);
    if (has_second) r = r * open_share(middle, load_row<F>(o.at[2]));
    if (has_first) r = r * sqrt(open_share(load_row<F>(o.at[0]), middle));
    return r;
}

/// One block's work; what is the same for all its rows.
struct SpaoBlock {
    const SpaoTile* tile = nullptr;
    CoarseRows coarse;  ///< for spao_block, where it goes on
    SpaoProduct product;
    std::int32_t last;  ///< the last shell that this grid answers for
    float normal_factor;
    bool of_surfaces;      ///< A / (1 + q) is asked for, not A (cells/surface_share.h)
    std::int32_t octants;  ///< 8, or 1 for the products over whole cubes
    bool goes_on;          ///< whether something lies further out
    /// Of the block's corners on a coarser grid, as far apart as the results: what they are worth to their neighbours.
    /// A corner inside opaque matter sees nothing, and must not darken the open cells beside it. Null: all the same.
    const std::uint16_t* weight = nullptr;
    std::int64_t weight_row = 0, weight_slice = 0;
};

/// A piece of a row: where it begins in the tile and the block, and what lies further out (CoarsePlanes,
/// CoarseAround).
template <class Coarse>
struct SpaoPiece {
    std::int32_t at, x, y;
    const Coarse* coarse;
};

/// One over what the weights of the corners around come to.
template <bool at_cells, bool goes_on, class F, class Coarse>
CHIARO_INLINE F further_scale(const SpaoPiece<Coarse>& p, int x) {
    if constexpr (goes_on) return F(1) / p.coarse->template weight_at<at_cells, F>(p.x + x, p.y);
    return F(1);
}
/// The product of the shells further out of octant s: the weighted mean over the corners around.
template <bool at_cells, bool goes_on, class F, class Coarse>
CHIARO_INLINE F further_out(const SpaoPiece<Coarse>& p, int x, int s, F scale) {
    if constexpr (goes_on) return min(p.coarse->template open_at<at_cells, F>(s, p.x + x, p.y) * scale, F(1));
    return F(1);
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

/// Whether nothing lies within reach of any of these cells. (Means are rounded up: only of zeros it is 0.)
template <bool at_cells, class F>
CHIARO_INLINE bool is_clear(const SpaoTile& tile, int at) {
    const auto row = [&](int s) CHIARO_INLINE_LAMBDA {
        return load_shorts<F>(octant_levels<at_cells>(tile, at, s).at[SpaoTile::shells]);
    };
    const auto low = mean_of(mean_of(row(0), row(1)), mean_of(row(2), row(3)));
    return is_zero(mean_of(low, mean_of(mean_of(row(4), row(5)), mean_of(row(6), row(7)))));
}

template <int s>
using Octant = std::integral_constant<int, s>;
/// use(s) for each of the eight octants, as a number that the compiler knows.
template <class Use>
CHIARO_INLINE void for_octants(Use&& use) {
    use(Octant<0>()), use(Octant<1>()), use(Octant<2>()), use(Octant<3>());
    use(Octant<4>()), use(Octant<5>()), use(Octant<6>()), use(Octant<7>());
}

/// The product so far of octant s at a corner, times the corner's weight.
template <class F>
CHIARO_INLINE void store_weighted(F product, const std::uint16_t* weight, std::uint16_t* to) {
    store_whole(truncate(product * load_row<F>(weight) + F(0.5f)), to);
}

/// Of cells that are clear: what lies further out, whichever way they face.
template <bool at_cells, bool goes_on, class F, int width, class Coarse>
CHIARO_INLINE void clear_octants(const SpaoPiece<Coarse>& p, int x, F scale, const std::uint16_t* weight,
                                 std::uint16_t (*out)[width]) {
    F all(0);
    for_octants([&](auto octant) CHIARO_INLINE_LAMBDA {
        constexpr int s = decltype(octant)::value;
        const F r = further_out<at_cells, goes_on>(p, x, s, scale);
        if constexpr (at_cells)
            all = all + r;
        else
            store_weighted(r, weight + x, out[s] + x);
    });
    if constexpr (at_cells) store_shares(min(F(0.125f) * all, F(1)), out[0] + x);
}

/// On the finest grid out[0] receives the accessibility, on a coarser one out[s] the product so far of octant s, times
/// the corners' weights. `width` cells, as everywhere below. Octants have weights wherever something lies further out.
template <bool at_cells, bool goes_on, class F, int width, class Coarse>
CHIARO_INLINE void octants_piece(const SpaoBlock& b, const SpaoPiece<Coarse>& p, const std::uint16_t* weight,
                                 std::uint16_t (*out)[width]) {
    const bool has_second = goes_on || b.last >= 1;
    for (int x = 0; x < width; x += LaneTraits<F>::count) {
        const F scale = further_scale<at_cells, goes_on, F>(p, x);
        if (is_clear<at_cells, F>(*b.tile, p.at + x)) {
            clear_octants<at_cells, goes_on>(p, x, scale, weight, out);
            continue;
        }
        const Vec3<F> n = step_down_row<F>(b.tile->opacity + p.at + x);
        F all(0), outwards(0);
        for_octants([&](auto octant) CHIARO_INLINE_LAMBDA {
            constexpr int s = decltype(octant)::value;
            const F r = join_octant(octant_levels<at_cells>(*b.tile, p.at + x, s), has_second, at_cells,
                                    further_out<at_cells, goes_on>(p, x, s, scale));
            if constexpr (at_cells) {
                const F side = (s & 1 ? n.x : F(0) - n.x) + (s & 2 ? n.y : F(0) - n.y) + (s & 4 ? n.z : F(0) - n.z);
                all = all + r;
                outwards = outwards + max(side, F(0)) * r;
            } else {
                store_weighted(r, weight + x, out[s] + x);
            }
        });
        if constexpr (at_cells) {
            const F q = outward_share(n, b.normal_factor);
            F access = min(weigh_octants(q, n, all, outwards), F(1));
            if (b.of_surfaces) access = access / (F(1) + q);
            store_shares(access, out[0] + x);
        }
    }
}

/// Means of the eight octants: the published cubes.
template <int width>
CHIARO_INLINE void cube_piece(const std::uint16_t* mean, int level, std::uint16_t (&piece)[width]) {
    for (int x = 0; x < width; ++x) {
        const auto at = [&](int s) CHIARO_INLINE_LAMBDA { return mean[x + octant_offset(level, s)]; };
        piece[x] = mean_of(mean_of(mean_of(at(0), at(1)), mean_of(at(2), at(3))),
                           mean_of(mean_of(at(4), at(5)), mean_of(at(6), at(7))));
    }
}

/// The same for the products over whole cubes, in out[0].
template <SpaoProduct product, bool at_cells, class F, int width, class Coarse>
CHIARO_INLINE void cubes_piece(const SpaoBlock& b, const SpaoPiece<Coarse>& p, std::uint16_t (*out)[width]) {
    std::uint16_t cubes[SpaoTile::shells][width];
    for (int l = 1; l <= SpaoTile::shells; ++l) cube_piece(level_of<at_cells>(*b.tile, l) + p.at, l, cubes[l - 1]);
    for (int x = 0; x < width; x += LaneTraits<F>::count) {
        const OctantLevels levels{{b.tile->opacity + p.at + x, cubes[0] + x, cubes[1] + x}};
        const F further = b.goes_on ? further_out<at_cells, true>(p, x, 0, F(1.0f / 65535)) : F(1);
        F r = join_cubes<product>(levels, b.last >= 1, at_cells, further);
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

template <bool at_cells, class F, int width, class Coarse>
CHIARO_INLINE void find_piece(const SpaoBlock& b, const SpaoPiece<Coarse>& p, const std::uint16_t* weight,
                              std::uint16_t (*out)[width]) {
    if (b.product == SpaoProduct::corrected && b.goes_on)
        octants_piece<at_cells, true, F, width>(b, p, weight, out);
    else if (b.product == SpaoProduct::corrected)
        octants_piece<at_cells, false, F, width>(b, p, weight, out);
    else if (b.product == SpaoProduct::thick)
        cubes_piece<SpaoProduct::thick, at_cells, F, width>(b, p, out);
    else
        cubes_piece<SpaoProduct::paper, at_cells, F, width>(b, p, out);
}

template <bool at_cells, class F, int width, class Coarse>
CHIARO_INLINE void spao_piece(const SpaoBlock& b, const SpaoPiece<Coarse>& p, const SpaoOutput& to, std::int32_t z) {
    std::uint16_t out[8][width];
    const std::int64_t at = z * to.slice + p.y * to.row + p.x;
    const std::int64_t of_weight = z * b.weight_slice + p.y * b.weight_row + p.x;
    find_piece<at_cells, F, width>(b, p, b.weight ? b.weight + of_weight : nullptr, out);
    for (std::int32_t s = 0; s < (at_cells ? 1 : b.octants); ++s) store_piece(out[s], p.x, to.nx, to.at[s] + at);
}

template <bool at_cells, class F>
CHIARO_INLINE void spao_block(const SpaoBlock& b, const SpaoOutput& to) {
    constexpr int halo = SpaoTile::halo;
    CoarsePlanes planes;
    for (std::int32_t z = 0; z < to.nz; ++z) {
        if (!any_asked(to.pieces, z)) continue;
        if (b.goes_on) planes.load<at_cells, F>(b.coarse, b.octants, z, to.ny);
        for (std::int32_t y = 0; y < to.ny; ++y)
            for (std::int32_t x = 0; x < to.nx; x += SpaoTile::piece) {
                if (!is_asked(to.pieces, x, y, z)) continue;
                const std::int32_t in_tile = (z + halo) * SpaoTile::slice + (y + halo) * SpaoTile::row + halo + x;
                const SpaoPiece<CoarsePlanes> piece{in_tile, x, y, &planes};
                spao_piece<at_cells, F, SpaoTile::piece>(b, piece, to, z);
            }
    }
}

}  // namespace chiaro::kernel

// Accessibility off surfaces, for one cell or sixteen of a row at a time: neighbours along x are neighbours in memory.
#pragma once
#include "illumination/cells/block_place.h"
#include "kernel/row.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

/// A block of floats and two cells around it.
struct NormalOffsetTile {
    static constexpr int edge = 32, halo = 2, row = edge + 2 * halo, slice = row * row, size = slice * row;
};

/// -(α(i + 1) - α(i - 1)) per axis; `alpha` points at the cell.
template <class F>
CHIARO_INLINE Vec3<F> step_down(const float* alpha, int row, int slice) {
    const auto along = [&](int d) CHIARO_INLINE_LAMBDA { return load_row<F>(alpha - d) - load_row<F>(alpha + d); };
    return {along(1), along(row), along(slice)};
}

/// min(1, 4 F |n|): a step of a quarter of the opacity between the neighbours is a surface. (With F |n| soft matter,
/// whose normals are .1 to .5, was answered mostly as if it had none.)
template <class F>
CHIARO_INLINE F outward_share(Vec3<F> n, float normal_factor) {
    return min(F(4 * normal_factor) * sqrt(dot(n, n)), F(1));
}

/// Of a cell with normal n: A × 2 / (1 + q), not clamped yet.
template <class F>
CHIARO_INLINE F scaled(F access, const float* opacity, float normal_factor) {
    const Vec3<F> n = step_down<F>(opacity, NormalOffsetTile::row, NormalOffsetTile::slice);
    if (!any_below(F(0), dot(n, n))) return access * F(2);  // q = 0
    return access * F(2) / (F(1) + outward_share(n, normal_factor));
}

/// The scaled field around a cell, on the side that its normal points to.
template <class F>
struct NeighboursAlong {
    const float* access;
    Mask<F> up_x, up_y, up_z;

    /// The cell's own value or its neighbour's along x, y and z.
    CHIARO_INLINE F at(bool x, bool y, bool z) const {
        return x ? select(up_x, yz(1, y, z), yz(-1, y, z)) : yz(0, y, z);
    }

private:
    CHIARO_INLINE F yz(int dx, bool y, bool z) const {
        constexpr int row = NormalOffsetTile::row;
        return y ? select(up_y, along_z(dx + row, z), along_z(dx - row, z)) : along_z(dx, z);
    }
    CHIARO_INLINE F along_z(int d, bool z) const {
        constexpr int slice = NormalOffsetTile::slice;
        const float* a = access + d;
        return z ? select(up_z, load_row<F>(a + slice), load_row<F>(a - slice)) : load_row<F>(a);
    }
};

/// The scaled field one edge along the normal: trilinear between the cell and the 7 neighbours on that side. These are
/// chosen first, so that there are 7 interpolations and not 13.
template <class F>
CHIARO_INLINE F displaced(const float* access, const float* opacity) {
    const Vec3<F> n = step_down<F>(opacity, NormalOffsetTile::row, NormalOffsetTile::slice);
    const F squared = dot(n, n);
    if (!any_below(F(0), squared)) return min(load_row<F>(access), F(1));
    const Vec3<F> d = (F(1) / max(sqrt(squared), F(1))) * n;
    const NeighboursAlong<F> around{access, d.x > F(0), d.y > F(0), d.z > F(0)};
    const auto along_x = [&](bool y, bool z) CHIARO_INLINE_LAMBDA {
        return lerp(around.at(false, y, z), around.at(true, y, z), abs(d.x));
    };
    const auto along_y = [&](bool z)
                             CHIARO_INLINE_LAMBDA { return lerp(along_x(false, z), along_x(true, z), abs(d.y)); };
    return min(lerp(along_y(false), along_y(true), abs(d.z)), F(1));
}

/// A block's work: access and opacity as 65535ths, each a tile; where the answers go, how much of the block lies there,
/// and the pieces of 16 × 4 × 4 cells that bit x of [z][y] asks for.
struct NormalOffsetBlock {
    const std::uint16_t *access, *opacity;
    float normal_factor;
    const std::uint8_t (*pieces)[NormalOffsetTile::edge / 4];
    std::uint16_t* out;
    std::int64_t row, slice;
    std::int32_t nx, ny, nz;
};

/// w / 65535 of whole numbers up to 65535, rounded as a division would: 1 / 65535 = 2^-16 (1 + 2^-16 + 2^-32 + ...).
template <class F>
CHIARO_INLINE F share_of(F whole) {
    return F(0x1p-16f) * whole + F(0x1p-32f + 0x1p-48f) * whole;
}

/// `numbers` holds two tiles and a piece more. Four slices of the block at a time, where they are asked for.
template <class F>
CHIARO_INLINE void normal_offset_block(const NormalOffsetBlock& b, float* numbers) {
    using Tile = NormalOffsetTile;
    constexpr int row = Tile::row, slice = Tile::slice, border = row + 1, lanes = LaneTraits<F>::count;
    float *scaled_access = numbers, *alpha = numbers + Tile::size;
    const auto share = [](const std::uint16_t* from) CHIARO_INLINE_LAMBDA { return share_of(load_row<F>(from)); };
    int converted = 0, scaled_end = 0;  // slices of the tile
    for (int first = 0; first < b.nz; first += 4) {
        if (!any_asked(b.pieces, first)) continue;
        const int end = min(first + 4, b.nz);
        for (converted = max(converted, first); converted < end + 4; ++converted)
            for (int i = converted * slice; i < (converted + 1) * slice; i += lanes)
                store_row(alpha + i, share(b.opacity + i));
        for (scaled_end = max(scaled_end, first + 1); scaled_end < end + 3; ++scaled_end)
            for (int i = scaled_end * slice + border; i < (scaled_end + 1) * slice - border; i += lanes)
                store_row(scaled_access + i, scaled(share(b.access + i), alpha + i, b.normal_factor));
        for (int z = first; z < end; ++z)
            for (int y = 0; y < b.ny; ++y)
                for (int x = 0; x < b.nx; x += BlockPlace::width) {
                    if (!is_asked(b.pieces, x, y, z)) continue;
                    const int at = (z + 2) * slice + (y + 2) * row + 2 + x;
                    std::uint16_t found[BlockPlace::width];
                    for (int i = 0; i < BlockPlace::width; i += lanes)
                        store_shares(displaced<F>(scaled_access + at + i, alpha + at + i), found + i);
                    store_piece(found, x, b.nx, b.out + z * b.slice + y * b.row + x);
                }
    }
}

/// The same for many threads, a cell each of blocks side by side.
struct NormalOffsetBatch {
    const BlockPlace* places;
    float* tiles;  ///< [block][2][NormalOffsetTile::size]: access, opacity
    const std::uint16_t *access, *opacity;
    std::int32_t count[3];
    float normal_factor;
    std::uint16_t* out;

    /// Item i of [0, NormalOffsetTile::size) of each block; beyond the grid the nearest cell's access, and no opacity.
    CHIARO_INLINE void load(std::int64_t item) const {
        const BlockItem<NormalOffsetTile::row, NormalOffsetTile::halo, NormalOffsetTile::size> its(places, item);
        const std::int32_t x = its.grid_x(), y = its.grid_y(), z = its.grid_z();
        const std::int32_t cx = within(x, 0), cy = within(y, 1), cz = within(z, 2);
        const std::int64_t at = (std::int64_t(cz) * count[1] + cy) * count[0] + cx;
        float* tile = tile_of(its.block);
        tile[its.i] = access[at] / 65535.0f;
        tile[NormalOffsetTile::size + its.i] = x == cx && y == cy && z == cz ? opacity[at] / 65535.0f : 0;
    }
    CHIARO_INLINE void scale(std::int64_t item) const {
        const std::int32_t i = std::int32_t(item % NormalOffsetTile::size);
        constexpr int border = NormalOffsetTile::slice + NormalOffsetTile::row + 1;
        if (i < border || i >= NormalOffsetTile::size - border) return;
        float* tile = tile_of(item / NormalOffsetTile::size);
        tile[i] = scaled<float>(tile[i], tile + NormalOffsetTile::size + i, normal_factor);
    }
    /// Item i of [0, BlockPlace::cells).
    CHIARO_INLINE void result(std::int64_t item) const {
        constexpr int halo = NormalOffsetTile::halo;
        const BlockCell its(places, item);
        const std::int32_t x = its.grid_x(), y = its.grid_y(), z = its.grid_z();
        if (x >= count[0] || y >= count[1] || z >= count[2] || !its.is_asked()) return;
        const float* tile = tile_of(its.block) + (its.z() + halo) * NormalOffsetTile::slice +
                            (its.y() + halo) * NormalOffsetTile::row + halo + its.x();
        store_shares(displaced<float>(tile, tile + NormalOffsetTile::size),
                     out + (std::int64_t(z) * count[1] + y) * count[0] + x);
    }

private:
    CHIARO_INLINE float* tile_of(std::int64_t block) const { return tiles + block * (2 * NormalOffsetTile::size); }
    CHIARO_INLINE std::int32_t within(std::int32_t i, int axis) const { return max(min(i, count[axis] - 1), 0); }
};

}  // namespace chiaro::kernel

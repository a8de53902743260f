// Density as many threads make it: tiles of 32³ cells side by side, halved, kept. The CPU's way to the same
// numbers is sub_voxel.cpp and rows.h, row by row in the cache.
#pragma once
#include "illumination/cells/block_place.h"
#include "illumination/cells/cell_kernel.h"
#include "illumination/visibility/rows.h"
#include "illumination/visibility/sub_voxel_integral_kernel.h"

namespace chiaro::kernel {

/// What a transfer function makes of voxels that are cells.
template <class Voxel, class SubVoxelIntegral>
struct DepthOfVoxels {
    VolumeView<Voxel> volume;
    CellCentres cells;
    SubVoxelIntegral sub_voxel;

    CHIARO_INLINE float operator()(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (cells.is_clipped(x, y, z)) return 0;
        return depth_among(sub_voxel, voxel_address(volume, x, y, z), brick_row, brick_slice) *
               factor_of_cell(volume, cells, x, y, z);
    }
};

/// Of cells between voxels.
template <class Voxel, class SubVoxelIntegral>
struct DepthBetweenVoxels {
    VolumeView<Voxel> volume;
    CellCentres cells;
    SubVoxelIntegral sub_voxel;

    CHIARO_INLINE typename SubVoxelIntegral::Level level(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const Vec3<float> p = volume.clamp(cells.of(x, y, z));
        return sub_voxel.level_of(volume.value(volume.locate(p, volume.voxel(p))));
    }
    CHIARO_INLINE float operator()(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (cells.is_clipped(x, y, z)) return 0;
        const auto here = sub_voxel.from(level(x, y, z));
        return ((here.to(level(x - 1, y, z)) + here.to(level(x + 1, y, z))) +
                (here.to(level(x, y - 1, z)) + here.to(level(x, y + 1, z))) +
                (here.to(level(x, y, z - 1)) + here.to(level(x, y, z + 1)))) *
               factor_of_cell(volume, cells, x, y, z);
    }
};

/// Of cells classified as points.
struct DepthOfOpacity {
    const std::uint16_t* opacity;
    const float* depth_of;  ///< [65536]
    std::int32_t row, rows;

    CHIARO_INLINE float operator()(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return depth_of[opacity[(std::int64_t(z) * rows + y) * row + x]];
    }
};

/// As it was found.
struct DepthOfNodes {
    const float* depth;
    std::int32_t row, rows;

    CHIARO_INLINE float operator()(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return depth[(std::int64_t(z) * rows + y) * row + x];
    }
};

/// A thread for each cell of the tiles: 0 where nothing is asked for.
template <class Depth>
struct FillTiles {
    Depth depth;
    std::int32_t count[4];  ///< cells per axis; the last fills up
    const BlockPlace* places;
    float* tiles;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const BlockCell its(places, item);
        const std::int32_t x = its.grid_x(), y = its.grid_y(), z = its.grid_z();
        const bool is_there = x < count[0] && y < count[1] && z < count[2] && its.is_asked();
        tiles[item] = is_there ? depth(x, y, z) : 0;
    }
};

/// A thread for each node of tiles of edge³ cells.
struct HalveTiles {
    const float* from;
    float* to;
    std::int32_t edge;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int32_t half = edge / 2, x = std::int32_t(item % half);
        const std::int64_t row = item / half, y = row % half, slice = row / half;  // of all tiles together
        const float* first = from + ((2 * slice) * edge + 2 * y) * edge + 2 * x;
        float depth[8], open[8];
        for (std::int32_t i = 0; i < 8; ++i) depth[i] = first[((i >> 2) * edge + (i >> 1 & 1)) * edge + (i & 1)];
        transmittance_row<float>(depth, 8, open);
        halve_row<float>({{open, open + 2, open + 4, open + 6}}, 1, to + item);
    }
};

/// A thread for each node of tiles of edge³: those within the grid are kept.
struct KeepTiles {
    const float* from;
    std::int32_t edge;
    const BlockPlace* places;
    std::int32_t count[3];
    float* to;

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int32_t size = edge * edge * edge, i = std::int32_t(item % size);
        const BlockPlace& place = places[item / size];
        const std::int32_t x = node(place, 0) + i % edge, y = node(place, 1) + i / edge % edge,
                           z = node(place, 2) + i / edge / edge;
        if (x < count[0] && y < count[1] && z < count[2])
            to[(std::int64_t(z) * count[1] + y) * count[0] + x] = from[item];
    }

private:
    CHIARO_INLINE std::int32_t node(const BlockPlace& place, int axis) const {
        return place.first[axis] / BlockPlace::edge * edge;
    }
};

}  // namespace chiaro::kernel

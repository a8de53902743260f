// The levels of a store that is written, and the boxes of voxels that its files hold.
#pragma once
#include <chiaro/zarr.h>

#include <vector>

namespace chiaro {

inline constexpr int zarr_chunk_edge = 64;
using ChunkPlace = std::array<int, 3>;  ///< x, y, z of a chunk among chunks, or of a shard among shards

struct PyramidLevel {
    std::array<int, 3> dimensions{};
    Geometry geometry;
    Vec3 shift_mm;                       ///< of voxel (0, 0, 0) against level 0's, along the volume's own axes
    std::array<int, 3> factor{1, 1, 1};  ///< voxels of the finer level that one of this stands for, per axis
};

/// Finest first, down to 64 voxels along the longest axis.
std::vector<PyramidLevel> pyramid_of(const SourceLevel& finest);

/// Voxels of a box, x fastest.
struct Block {
    VoxelBox box;
    VoxelBuffer voxels;
};

/// Puts what a finer level's block becomes into the block of the coarser that holds it.
void put_coarser(const Block& finer, VoxelType type, const std::array<int, 3>& factor, LevelsBy by, int threads,
                 Block& coarser);

}  // namespace chiaro

// What labels make of a medium, in bricks as the volume's voxels lie (volume/bricks.h).
#pragma once
#include <chiaro/volume.h>

#include <cstdint>

namespace chiaro {

/// Signed distances in a byte: middle + per_voxel * voxels, positive in what is shown.
struct LabelCoding {
    static constexpr int middle = 128, reach = 2;
    static constexpr float per_voxel = 63;
    static constexpr std::uint8_t shown = 254, hidden = 2;  ///< farther than `reach` from a border
};

struct LabelBricks {
    VoxelBuffer distance;  ///< uint8, of the border of what is shown; empty: all is
    VoxelBuffer share;     ///< uint8, of 255: opacity; empty: 1
    VoxelBuffer tint;      ///< uint8 red, green, blue, strength, of 255; colours as square roots; empty: none
};

}  // namespace chiaro

// What labels make of a medium, in bricks as the volume's voxels lie (volume/bricks.h).
#pragma once
#include <chiaro/volume.h>

#include "volume/label_coding.h"

namespace chiaro {

struct LabelBricks {
    VoxelBuffer distance;  ///< uint8, of the border of what is shown; empty: all is
    VoxelBuffer share;     ///< uint8, of 255: opacity; empty: 1
    VoxelBuffer tint;      ///< uint8 red, green, blue, strength, of 255; colours as square roots; empty: none
};

}  // namespace chiaro

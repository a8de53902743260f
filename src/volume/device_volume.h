// What stands behind a DeviceVolume.
#pragma once
#include <chiaro/medium.h>

#include <vector>

#include "volume/bricks.h"

namespace chiaro {

/// Smallest and largest stored value in each 4³ cell, its shared border included.
struct CellRanges {
    std::array<int, 3> count{0, 0, 0};
    std::vector<float> low, high;  ///< x fastest
};

struct DeviceVolume::Data {
    Device device;
    std::array<int, 3> dimensions{0, 0, 0};
    Geometry geometry;
    VoxelType stored = VoxelType::u8;  ///< u8, u16 or f32
    VoxelBuffer bricks;
    double scale = 1, offset = 0;  ///< value = scale * stored + offset
    bool whole_numbers = false;    ///< the stored values are integers
    CellRanges cells;
    float stored_min = 0, stored_max = 0;
};

}  // namespace chiaro

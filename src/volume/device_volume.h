// What stands behind a DeviceVolume.
#pragma once
#include <chiaro/medium.h>

#include <memory>
#include <vector>

#include "core/host_array.h"
#include "volume/bricks.h"

namespace chiaro {

/// Smallest and largest stored value in each 4³ cell, its shared border included.
struct CellRanges {
    std::array<int, 3> count{0, 0, 0};
    std::vector<float> low, high;  ///< x fastest
};

struct DeviceVolume::Data : std::enable_shared_from_this<Data> {
    Device device;
    std::array<int, 3> dimensions{0, 0, 0};
    Geometry geometry;
    VoxelType stored = VoxelType::u8;  ///< u8, u16 or f32
    VoxelBuffer bricks;
    double scale = 1, offset = 0;     ///< value = scale * stored + offset
    double shift = 0, intercept = 0;  ///< the same to the last bit: scale * (stored + shift) + intercept
    bool exact = true;                ///< no voxel was rounded or replaced when it was stored
    bool whole_numbers = false;       ///< the stored values are integers
    CellRanges cells;
    float stored_min = 0, stored_max = 0;

    /// The file's own value of a stored number.
    double value_of(double number) const { return scale * (number + shift) + intercept; }

    void add_to(HostArrays& arrays) const {
        arrays.add(weak_from_this(), bricks);
        arrays.add(weak_from_this(), cells.low);
        arrays.add(weak_from_this(), cells.high);
    }
};

}  // namespace chiaro

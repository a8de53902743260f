// The ranges of all bricks of a source's finest level: what is found by reading every voxel once.
#pragma once
#include <chiaro/brick_source.h>

#include <vector>

#include "volume/device_volume.h"

namespace chiaro {

struct BrickRanges {
    std::vector<float> low, high;  ///< stored values of each brick with its border, x fastest
    float least = 0, largest = 0;  ///< of the volume
};

/// `like`: another level as it is stored. Cost: all voxels are read; 8 bytes a brick. Throws Error{input} where one
/// cannot be read or none is finite, Error{interrupted} when cancelled. Reported as "ranges".
BrickRanges exact_ranges(const BrickSource& source, const DeviceVolume::Data& like, Progress& progress);

}  // namespace chiaro

// A device volume with some voxels changed.
#pragma once
#include <functional>

#include "volume/device_volume.h"

namespace chiaro {

/// A copy with the voxels at which `is_changed` (x fastest) holds a byte other than 0 replaced by new_value(stored).
/// Cost: a copy of the bricks, which stays, and a pass over them. Throws Error{output} where there is no memory.
DeviceVolume edited(const DeviceVolume& volume, const std::vector<std::uint8_t>& is_changed,
                    const std::function<float(float stored)>& new_value);

/// The stored value of voxel (x, y, z).
template <class Voxel>
Voxel stored_at(const DeviceVolume::Data& volume, int x, int y, int z) {
    // The last voxel of an axis is the border of the last brick.
    const auto brick = [](int i, int n) { return std::min(i / brick_edge, brick_count(n) - 1); };
    const auto& n = volume.dimensions;
    const std::array<int, 3> b{brick(x, n[0]), brick(y, n[1]), brick(z, n[2])};
    const std::size_t index = (std::size_t(b[2]) * brick_count(n[1]) + b[1]) * brick_count(n[0]) + b[0];
    const int local =
        ((z - b[2] * brick_edge + brick_before) * brick_row + y - b[1] * brick_edge + brick_before) * brick_row + x -
        b[0] * brick_edge + brick_before;
    return reinterpret_cast<const Voxel*>(volume.bricks.data())[index * brick_voxels + std::size_t(local)];
}

}  // namespace chiaro

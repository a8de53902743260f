// From a DeviceVolume to what a kernel reads.
#pragma once
#include <algorithm>

#include "volume/device_volume.h"
#include "volume/view.h"

namespace chiaro {

/// `Voxel` is the stored type.
template <class Voxel>
kernel::VolumeView<Voxel> view_of(const DeviceVolume::Data& volume) {
    const auto [nx, ny, nz] = volume.dimensions;
    return {reinterpret_cast<const Voxel*>(volume.bricks.data()),
            brick_count(nx),
            brick_count(ny),
            {float(nx - 1), float(ny - 1), float(nz - 1)},
            std::max(nx - 2, 0),
            std::max(ny - 2, 0),
            std::max(nz - 2, 0)};
}

}  // namespace chiaro

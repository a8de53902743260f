// A device volume with some voxels changed.
#pragma once
#include <functional>

#include "volume/device_volume.h"

namespace chiaro {

/// A copy with the voxels at which `is_changed` (x fastest) holds a byte other than 0 replaced by new_value(stored);
/// `bounds` are those of its spline. Cost: a copy of the bricks, which stays, and a pass over them. Throws
/// Error{output} where there is no memory.
DeviceVolume edited(const DeviceVolume& volume, const std::vector<std::uint8_t>& is_changed,
                    const std::function<float(float stored)>& new_value,
                    std::shared_ptr<const CoefficientBounds> bounds = nullptr);

}  // namespace chiaro

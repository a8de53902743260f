// A volume that lends another one its bricks.
#pragma once
#include "volume/device_volume.h"

namespace chiaro {

/// All of `plain`, which it keeps, to be looked at in another way.
inline std::shared_ptr<DeviceVolume::Data> borrowed(const DeviceVolume& plain) {
    const DeviceVolume::Data& from = plain.data();
    const auto borrow = [](const VoxelBuffer& buffer) {
        return VoxelBuffer::borrow(buffer.data(), buffer.size(), nullptr);
    };
    auto made = std::make_shared<DeviceVolume::Data>();
    made->describe_as(from);
    made->cells = from.cells;
    made->stored_min = from.stored_min, made->stored_max = from.stored_max;
    made->bricks = borrow(from.bricks), made->coefficients = borrow(from.coefficients);
    made->spline = from.spline, made->normal_reach = from.normal_reach;
    made->plain = plain;
    return made;
}

}  // namespace chiaro

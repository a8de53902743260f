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
    const SplineCoding& spline = volume.spline;
    const auto& reach = volume.normal_reach;
    const auto* coefficients = reinterpret_cast<const Voxel*>(volume.coefficients.data());
    return {reinterpret_cast<const Voxel*>(volume.bricks.data()),
            brick_count(nx),
            brick_count(ny),
            {float(nx - 1), float(ny - 1), float(nz - 1)},
            std::max(nx - 2, 0),
            std::max(ny - 2, 0),
            std::max(nz - 2, 0),
            {coefficients, spline.base, spline.scale, spline.least, {reach[0], reach[1], reach[2]}}};
}

/// Calls f with a value of the type that the voxels are stored as.
template <class Function>
decltype(auto) with_stored_voxel(const DeviceVolume::Data& volume, Function&& f) {
    switch (volume.stored) {
        case VoxelType::u8:
            return f(std::uint8_t{});
        case VoxelType::u16:
            return f(std::uint16_t{});
        default:
            return f(float{});
    }
}

}  // namespace chiaro

namespace chiaro::kernel {

template <class Views, class Voxel>
void swap_pointers(Views& views, VolumeView<Voxel>& view) {
    views.to_device_pointers(view.voxels, view.spline.coefficients);
}

}  // namespace chiaro::kernel

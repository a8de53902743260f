// What stands behind a DeviceVolume that is a level by bricks.
#pragma once
#include <cstdint>
#include <vector>

#include "volume/device_view.h"
#include "volume/paged_view.h"

namespace chiaro {

/// Which bricks of a level are there.
struct LevelPages {
    std::array<int, 3> bricks{0, 0, 0};
    DeviceVolume coarse;                ///< stands for what is absent; its bricks are copied behind the slots
    std::uint32_t first_coarse = 0;     ///< where, in voxels
    std::vector<std::int32_t> slots;    ///< of each brick, x fastest, as kernel::BrickTable has it
    std::vector<std::uint8_t> seen;     ///< of each brick: whether a ray came through
    VoxelBuffer codes;                  ///< [slot][cell]
    std::array<double, 3> per_voxel{};  ///< coarse voxel = voxel × per_voxel + shift
    std::array<double, 3> shift{};
};

template <>
inline kernel::VolumeView<kernel::Paged> view_of<kernel::Paged>(const DeviceVolume::Data& volume) {
    const LevelPages& pages = *volume.pages;
    const auto grid_of = [](const DeviceVolume::Data& of) {
        kernel::VolumeView<float> grid = view_of<float>(of);
        grid.voxels = nullptr;
        return grid;
    };
    const auto float3 = [](const std::array<double, 3>& v) {
        return kernel::Float3{float(v[0]), float(v[1]), float(v[2])};
    };
    auto* seen = const_cast<std::uint8_t*>(pages.seen.data());  // all that rays change
    return {{grid_of(volume)},
            grid_of(pages.coarse.data()),
            float3(pages.per_voxel),
            float3(pages.shift),
            {reinterpret_cast<const std::uint32_t*>(pages.slots.data()), seen,
             reinterpret_cast<const std::uint8_t*>(pages.codes.data()), pages.bricks[0], pages.bricks[1]},
            pages.first_coarse,
            volume.bricks.data(),
            std::int32_t(size_of(volume.stored))};
}

}  // namespace chiaro

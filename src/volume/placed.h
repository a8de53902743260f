// A volume of which this process holds a block.
#pragma once
#include <chiaro/brick_source.h>

#include "volume/device_volume.h"

namespace chiaro {

/// The first and last of the bricks, along each axis, that hold something of a box of voxels.
struct BrickRange {
    std::array<int, 3> first{0, 0, 0}, end{0, 0, 0};  ///< half-open
};
inline BrickRange bricks_of(const VoxelBox& box, const std::array<int, 3>& dimensions) {
    BrickRange range;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (box.size[axis] < 1) return {};
        const int count = brick_count(dimensions[axis]), last = box.first[axis] + box.size[axis] - 1;
        range.first[axis] = std::min(std::max(box.first[axis] - 1, 0) / brick_edge, count - 1);
        range.end[axis] = std::min(last / brick_edge, count - 1) + 1;
    }
    return range;
}

/// Which 4³ cells hold one of the voxels that are there; empty: all.
inline std::vector<std::uint8_t> cells_held(const DeviceVolume::Data& volume) {
    if (!volume.placement) return {};
    const auto& count = volume.cells.count;
    std::vector<std::uint8_t> held(volume.cells.low.size());
    std::array<int, 3> first, end;
    for (std::size_t a = 0; a < 3; ++a) {
        if (volume.held.size[a] < 1) return held;
        first[a] = std::min(std::max(volume.held.first[a] - 1, 0) / cell_edge, count[a] - 1);
        end[a] = std::min((volume.held.first[a] + volume.held.size[a] - 1) / cell_edge, count[a] - 1) + 1;
    }
    for (int z = first[2]; z < end[2]; ++z)
        for (int y = first[1]; y < end[1]; ++y)
            std::fill_n(held.begin() + (std::ptrdiff_t(z) * count[1] + y) * count[0] + first[0], end[0] - first[0], 1);
    return held;
}

}  // namespace chiaro

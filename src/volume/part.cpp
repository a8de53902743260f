#include "volume/part.h"

#include <algorithm>
#include <cmath>

#include "volume/device_volume.h"

namespace chiaro {

VoxelBox box_around(const SourceLevel& level, Vec3 low, Vec3 high) {
    VoxelBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double n = level.dimensions[axis];
        const int first = int(std::clamp(std::floor(low[int(axis)]) - 1, 0.0, n)),
                  end = int(std::clamp(std::ceil(high[int(axis)]) + 2, 0.0, n));
        box.first[axis] = first, box.size[axis] = std::max(end - first, 0);
    }
    return box;
}

double voxels_in(const VoxelBox& box) { return double(box.size[0]) * box.size[1] * box.size[2]; }

DeviceVolume part_of(const BrickSource& source, int level, const VoxelBox& box, const DeviceVolume& whole) {
    const Volume& header = source.header();
    Volume part = make_volume(box.size, header.type);
    part.geometry = source.levels()[std::size_t(level)].geometry;
    part.geometry.origin_mm =
        part.geometry.world_from_voxel({double(box.first[0]), double(box.first[1]), double(box.first[2])});
    part.slope = header.slope, part.intercept = header.intercept, part.source = header.source;
    source.read(level, box, part.voxels.data());
    DeviceVolume uploaded = upload(Device::cpu(whole.data().device.threads), std::move(part));
    auto& data = const_cast<DeviceVolume::Data&>(uploaded.data());  // nobody else has it yet
    const auto its = [&](float stored) { return float((whole.data().value_of(stored) - data.offset) / data.scale); };
    data.stored_min = std::min(data.stored_min, its(whole.data().stored_min));
    data.stored_max = std::max(data.stored_max, its(whole.data().stored_max));
    return uploaded;
}

}  // namespace chiaro

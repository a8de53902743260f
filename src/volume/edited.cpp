#include "volume/edited.h"

#include <cstring>

#include "core/threads.h"
#include "volume/cell_ranges.h"
#include "volume/device_view.h"

namespace chiaro {

DeviceVolume edited(const DeviceVolume& volume, const std::vector<std::uint8_t>& is_changed,
                    const std::function<float(float)>& new_value, std::shared_ptr<const CoefficientBounds> bounds) {
    const DeviceVolume::Data& source = volume.data();
    auto made = std::make_shared<DeviceVolume::Data>();
    made->describe_as(source);
    made->cells = source.cells;
    made->bounds = std::move(bounds);
    made->bricks = VoxelBuffer(source.bricks.size());
    std::memcpy(made->bricks.data(), source.bricks.data(), source.bricks.size());
    const std::array<int, 3> bricks{brick_count(source.dimensions[0]), brick_count(source.dimensions[1]),
                                    brick_count(source.dimensions[2])};
    with_stored_voxel(source, [&](auto zero) {
        using Voxel = decltype(zero);
        auto* all = reinterpret_cast<Voxel*>(made->bricks.data());
        parallel_for(source.device.threads, std::int64_t(bricks[0]) * bricks[1] * bricks[2], 1,
                     [&](std::int64_t b, std::int64_t) {
                         const std::array<int, 3> at{int(b % bricks[0]), int(b / bricks[0] % bricks[1]),
                                                     int(b / (std::int64_t(bricks[0]) * bricks[1]))};
                         Voxel* brick = all + std::size_t(b) * brick_voxels;
                         for_each_of_brick(source.dimensions, at, brick_row, brick,
                                           [&](Voxel& stored, std::size_t voxel) {
                                               if (is_changed[voxel]) stored = Voxel(new_value(float(stored)));
                                           });
                         fill_cells(brick, at, brick_row, made->cells);
                     });
    });
    made->stored_min = *std::min_element(made->cells.low.begin(), made->cells.low.end());
    made->stored_max = *std::max_element(made->cells.high.begin(), made->cells.high.end());
    return DeviceVolume(std::move(made));
}

}  // namespace chiaro

#include "volume/edited.h"

#include <cstring>

#include "core/threads.h"
#include "volume/cell_ranges.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

/// Replaces the voxels of a brick, those of its border too.
template <class Voxel>
void edit_brick(const DeviceVolume::Data& volume, std::array<int, 3> brick, const std::vector<std::uint8_t>& is_changed,
                const std::function<float(float)>& new_value, Voxel* voxels) {
    const auto [nx, ny, nz] = volume.dimensions;
    for (int z = 0; z < brick_row; ++z)
        for (int y = 0; y < brick_row; ++y)
            for (int x = 0; x < brick_row; ++x) {
                const auto at = [&](int i, int axis, int n) {
                    return std::clamp(brick[std::size_t(axis)] * brick_edge - brick_before + i, 0, n - 1);
                };
                const std::size_t voxel = (std::size_t(at(z, 2, nz)) * ny + at(y, 1, ny)) * nx + at(x, 0, nx);
                Voxel& stored = voxels[z * brick_slice + y * brick_row + x];
                if (is_changed[voxel]) stored = Voxel(new_value(float(stored)));
            }
}

}  // namespace

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
                         edit_brick(source, at, is_changed, new_value, brick);
                         fill_cells(brick, at, brick_row, made->cells);
                     });
    });
    made->stored_min = *std::min_element(made->cells.low.begin(), made->cells.low.end());
    made->stored_max = *std::max_element(made->cells.high.begin(), made->cells.high.end());
    return DeviceVolume(std::move(made));
}

}  // namespace chiaro

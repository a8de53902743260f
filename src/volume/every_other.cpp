#include "volume/every_other.h"

#include "core/threads.h"
#include "volume/cell_ranges.h"
#include "volume/device_view.h"
#include "volume/fill_brick.h"

namespace chiaro {
namespace {

template <class Stored>
void fill(const DeviceVolume::Data& from, const Progress& progress, DeviceVolume::Data& data) {
    const auto [nx, ny, nz] = data.dimensions;
    const auto* voxels = reinterpret_cast<const Stored*>(from.bricks.data());
    VoxelBuffer rows(std::size_t(nx) * ny * nz * sizeof(Stored));
    auto* to = reinterpret_cast<Stored*>(rows.data());
    parallel_for(data.device.threads, std::int64_t(ny) * nz, 64, [&, nx = nx, ny = ny](auto first, auto end) {
        for (auto row = first; row < end && !progress.cancelled(); ++row)
            for (int x = 0; x < nx; ++x)
                to[row * nx + x] = voxels[voxel_index(from, 2 * x, 2 * int(row % ny), 2 * int(row / ny))];
    });
    progress.check();
    const std::array<int, 3> bricks{brick_count(nx), brick_count(ny), brick_count(nz)};
    const std::int64_t count = std::int64_t(bricks[0]) * bricks[1] * bricks[2];
    data.bricks = VoxelBuffer((std::size_t(count) * brick_voxels + 4) * sizeof(Stored));  // as upload has it
    data.cells.count = {cell_count(nx), cell_count(ny), cell_count(nz)};
    data.cells.low.resize(std::size_t(data.cells.count[0]) * data.cells.count[1] * data.cells.count[2]);
    data.cells.high.resize(data.cells.low.size());
    parallel_for(data.device.threads, count, 1, [&, nz = nz](std::int64_t b, std::int64_t) {
        const std::array<int, 3> at{int(b % bricks[0]), int(b / bricks[0] % bricks[1]), int(b / bricks[0] / bricks[1])};
        Stored* brick = reinterpret_cast<Stored*>(data.bricks.data()) + b * brick_voxels;
        fill_brick(BoxedVoxels<Stored>{to, data.held}, Conversion<Stored>{}, at, slices_read(nz, at[2]), brick);
        fill_cells(brick, at, brick_row, data.cells);
    });
    progress.check();
}

}  // namespace

DeviceVolume every_other_voxel(const DeviceVolume& volume, const Progress& progress) {
    const DeviceVolume::Data& from = volume.data();
    auto data = std::make_shared<DeviceVolume::Data>();
    data->describe_as(from);
    for (int axis = 0; axis < 3; ++axis) {
        data->dimensions[axis] = (from.dimensions[axis] + 1) / 2;
        data->geometry.spacing_mm[axis] *= 2;
    }
    data->held = {{0, 0, 0}, data->dimensions};
    data->stored_min = from.stored_min, data->stored_max = from.stored_max;  // a function's table spans the same
    with_stored_voxel(from, [&](auto voxel) { fill<decltype(voxel)>(from, progress, *data); });
    return DeviceVolume(std::move(data));
}

}  // namespace chiaro

// Volumes of one grid as channels, which kernels read in one stored type.
#include <chiaro/error.h>

#include <algorithm>

#include "core/threads.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

template <class From, class To>
void copy_numbers(const VoxelBuffer& from, VoxelBuffer& to, int threads) {
    const std::size_t count = from.size() / sizeof(From);
    to = VoxelBuffer(count * sizeof(To));
    const auto* source = reinterpret_cast<const From*>(from.data());
    auto* out = reinterpret_cast<To*>(to.data());
    parallel_for(threads, std::int64_t(count), 1 << 20,
                 [&](std::int64_t first, std::int64_t end) { std::copy(source + first, source + end, out + first); });
}

/// The same numbers, wider.
DeviceVolume widened(const DeviceVolume& volume, VoxelType type) {
    const DeviceVolume::Data& from = volume.data();
    if (from.stored == type) return volume;
    auto made = std::make_shared<DeviceVolume::Data>();
    made->describe_as(from);
    made->stored = type;
    made->cells = from.cells;
    made->stored_min = from.stored_min, made->stored_max = from.stored_max;
    made->normal_reach = from.normal_reach;
    with_stored_voxel(from, [&](auto voxel) {
        with_stored_voxel(*made, [&](auto wide) {
            copy_numbers<decltype(voxel), decltype(wide)>(from.bricks, made->bricks, from.device.threads);
        });
    });
    return DeviceVolume(std::move(made));
}

}  // namespace

std::vector<DeviceVolume> alike(const std::vector<DeviceVolume>& volumes) {
    VoxelType widest = VoxelType::u8;
    for (const DeviceVolume& volume : volumes) {
        if (volume.dimensions() != volumes.front().dimensions())
            throw Error(ErrorCode::input, "channels need one grid: resample them onto the first's");
        widest = std::max(widest, volume.data().stored);  // u8 < u16 < f32
    }
    static_assert(VoxelType::u8 < VoxelType::u16 && VoxelType::u16 < VoxelType::f32);
    std::vector<DeviceVolume> all;
    for (const DeviceVolume& volume : volumes) all.push_back(widened(volume, widest));
    return all;
}

}  // namespace chiaro

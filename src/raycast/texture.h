// The volume's texture on a GPU.
#pragma once
#include "cuda/device_cache.h"
#include "volume/device_view.h"
#include "volume/texture_view.h"

namespace chiaro {

/// Made of the bricks when first asked for, and kept there as long as the volume is; false where the GPU cannot have
/// it, and the stream then tells so. Cost: the voxels once more in the GPU's memory.
bool find_texture(const DeviceVolume::Data& volume, cuda::Stream& stream, kernel::VolumeView<kernel::Texel>& view);

/// Without a texture.
template <>
inline kernel::VolumeView<kernel::Texel> view_of<kernel::Texel>(const DeviceVolume::Data& volume) {
    kernel::VolumeView<float> grid = view_of<float>(volume);
    grid.voxels = nullptr;
    return {{grid}, 0, volume.stored == VoxelType::u8 ? 255.0f : volume.stored == VoxelType::u16 ? 65535.0f : 1.0f};
}

}  // namespace chiaro

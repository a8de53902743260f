#include "raycast/texture.h"

#include <algorithm>

#include "cuda/texture.h"

namespace chiaro {
namespace {

constexpr std::size_t first_inside = brick_before * (brick_slice + brick_row + 1);

/// Each brick brings its voxels and the next, which the last one answers for too.
void fill(cuda::Texture& texture, const DeviceVolume::Data& volume, const std::byte* bricks, std::size_t voxel_bytes,
          cuda::Stream& stream) {
    const auto& n = volume.dimensions;
    const std::array<int, 3> count{brick_count(n[0]), brick_count(n[1]), brick_count(n[2])};
    for (std::size_t b = 0; b < std::size_t(count[0]) * count[1] * count[2]; ++b) {
        const std::array<int, 3> at{int(b % count[0]), int(b / count[0] % count[1]), int(b / count[0] / count[1])};
        cuda::Texture::Box box{bricks + (b * brick_voxels + first_inside) * voxel_bytes, brick_row, {}, {}};
        for (int axis = 0; axis < 3; ++axis) {
            box.to[axis] = at[axis] * brick_edge;
            box.size[axis] = std::min(brick_edge + 1, n[axis] - box.to[axis]);
        }
        texture.copy(stream, box);
    }
}

}  // namespace

bool find_texture(const DeviceVolume::Data& volume, cuda::Stream& stream, kernel::VolumeView<kernel::Texel>& view) {
    HostArrays arrays;
    volume.add_to(arrays);
    const std::byte* bricks = volume.bricks.data();
    cuda::Views(stream, std::move(arrays)).to_device_pointers(bricks);
    const auto make = [&] {
        return with_stored_voxel(volume, [&](auto voxel) {
            constexpr auto texel = sizeof voxel == 1   ? cuda::Texel::u8
                                   : sizeof voxel == 2 ? cuda::Texel::u16
                                                       : cuda::Texel::f32;
            auto texture = std::make_unique<cuda::Texture>(stream, texel, volume.dimensions);
            fill(*texture, volume, bricks, sizeof voxel, stream);
            return texture;
        });
    };
    std::string without;
    try {
        view.texture =
            stream.device_cache()->texture(HostArray::of(volume.weak_from_this(), volume.bricks), stream, make);
    } catch (const cuda::NoTexture& why) {
        without = std::string(why.what()) + "; samples are interpolated exactly, not by texture units";
    }
    stream.do_without(without);
    return without.empty();
}

}  // namespace chiaro

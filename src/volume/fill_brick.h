// From a volume's voxels to a brick of device numbers.
#pragma once
#include <chiaro/brick_source.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "volume/device_volume.h"

namespace chiaro {

inline constexpr double below_2_41 =
    0x1.fffffep40;  ///< the last float: the largest double may not be rounded up to infinity

/// How stored numbers become device numbers: device = stored - shift, then clamped to [low, high] where that is not
/// finite; of floating-point numbers times 2^exponent.
template <class Source>
struct Conversion {
    Source shift = 0;
    Source low = 0, high = 0;
    int exponent = 0;
    bool all_finite = true;
};

template <class Device, class Source>
Device convert(Source v, const Conversion<Source>& c) {
    if constexpr (std::is_floating_point_v<Source>) {
        // NaN reads as the smallest value, which transfer functions leave empty more often than any other.
        if (!std::isfinite(v)) v = v > 0 ? c.high : c.low;
        if (c.exponent == 0) return Device(v);
        return Device(std::clamp(double(std::ldexp(v, c.exponent)), -below_2_41, below_2_41));
    } else if constexpr (std::is_floating_point_v<Device>) {
        return Device(v);
    } else {
        return Device(std::make_unsigned_t<Source>(v) - std::make_unsigned_t<Source>(c.shift));
    }
}

/// What of a volume lies in memory.
template <class Source>
struct BoxedVoxels {
    const Source* voxels;  ///< of the box, x fastest
    VoxelBox box;
};

/// Of the volume, what a brick and its border hold.
inline VoxelBox box_of_brick(std::array<int, 3> brick, const std::array<int, 3>& dimensions) {
    VoxelBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int first = brick[axis] * brick_edge - brick_before, last = dimensions[axis] - 1;
        box.first[axis] = std::clamp(first, 0, last);
        box.size[axis] = std::clamp(first + brick_row - 1, 0, last) - box.first[axis] + 1;
    }
    return box;
}

/// Fills one brick, border included, or as many of its slices; outside the box, the nearest voxel stands.
template <class Source, class Device>
void fill_brick(const BoxedVoxels<Source>& from, const Conversion<Source>& conversion, std::array<int, 3> brick,
                int slices, Device* out) {
    const auto [first_x, first_y, first_z] = from.box.first;
    const auto [size_x, size_y, size_z] = from.box.size;
    const int x0 = brick[0] * brick_edge - brick_before - first_x;
    for (int z = 0; z < slices; ++z)
        for (int y = 0; y < brick_row; ++y) {
            const int sz = std::clamp(brick[2] * brick_edge - brick_before + z - first_z, 0, size_z - 1);
            const int sy = std::clamp(brick[1] * brick_edge - brick_before + y - first_y, 0, size_y - 1);
            const Source* row = from.voxels + (std::size_t(sz) * size_y + sy) * size_x;
            Device* to = out + z * brick_slice + y * brick_row;
            const int begin = std::clamp(-x0, 0, brick_row), end = std::clamp(size_x - x0, begin, brick_row);
            for (int x = 0; x < begin; ++x) to[x] = convert<Device>(row[0], conversion);
            for (int x = begin; x < end; ++x) to[x] = convert<Device>(row[x0 + x], conversion);
            for (int x = end; x < brick_row; ++x) to[x] = convert<Device>(row[size_x - 1], conversion);
        }
}

}  // namespace chiaro

// From a volume's voxels to a brick of device numbers.
#pragma once
#include <chiaro/brick_source.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "volume/device_volume.h"

namespace chiaro {

inline constexpr double below_2_41 =
    0x1.fffffep40;  ///< the last float: the largest double may not be rounded up to infinity

/// How stored numbers become device numbers: device = stored - shift; low or high stands for one that is not finite.
/// Floating-point numbers with an exponent have no shift: device = stored * 2^exponent.
template <class Source>
struct Conversion {
    Source shift = 0;
    Source low = 0, high = 0;
    int exponent = 0;
    bool all_finite = true;

    /// Whether device numbers are sure to be the stored ones, bit by bit.
    template <class Device>
    bool keeps() const {
        return std::is_same_v<Source, Device> && std::is_integral_v<Source> && shift == 0;
    }
};

template <class Device, class Source>
Device convert(Source v, const Conversion<Source>& c) {
    if constexpr (std::is_floating_point_v<Source>) {
        // NaN reads as the smallest value, which transfer functions leave empty more often than any other.
        if (!std::isfinite(v)) v = v > 0 ? c.high : c.low;
        if (c.exponent == 0) return Device(v - c.shift);
        return Device(std::clamp(double(std::ldexp(v, c.exponent)), -below_2_41, below_2_41));
    } else if constexpr (std::is_floating_point_v<Device>) {
        return c.shift == 0 ? Device(v)
                            : Device(std::make_unsigned_t<Source>(v) - std::make_unsigned_t<Source>(c.shift));
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
    const auto [size_x, size_y, size_z] = from.box.size;
    std::array<int, 3> first;
    for (std::size_t axis = 0; axis < 3; ++axis)
        first[axis] = brick[axis] * brick_edge - brick_before - from.box.first[axis];
    const int x0 = first[0], begin = std::clamp(-x0, 0, brick_row), end = std::clamp(size_x - x0, begin, brick_row);
    const bool is_whole = begin == 0 && end == brick_row, is_copy = is_whole && conversion.template keeps<Device>();
    std::array<std::size_t, brick_row> row_of;
    for (int y = 0; y < brick_row; ++y) row_of[y] = std::size_t(std::clamp(first[1] + y, 0, size_y - 1)) * size_x;
    for (int z = 0; z < slices; ++z) {
        const Source* slice = from.voxels + std::size_t(std::clamp(first[2] + z, 0, size_z - 1)) * size_y * size_x;
        Device* to = out + z * brick_slice;
        for (int y = 0; y < brick_row; ++y, to += brick_row) {
            const Source* row = slice + row_of[y];
            if (is_copy) {
                std::memcpy(to, row + x0, brick_row * sizeof(Device));
            } else if (is_whole) {  // a loop of known length
                for (int x = 0; x < brick_row; ++x) to[x] = convert<Device>(row[x0 + x], conversion);
            } else {
                for (int x = 0; x < begin; ++x) to[x] = convert<Device>(row[0], conversion);
                for (int x = begin; x < end; ++x) to[x] = convert<Device>(row[x0 + x], conversion);
                for (int x = end; x < brick_row; ++x) to[x] = convert<Device>(row[size_x - 1], conversion);
            }
        }
    }
}

}  // namespace chiaro

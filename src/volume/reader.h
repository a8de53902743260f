// The volume's values one at a time, in data units and double precision: for what is measured, not drawn.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "volume/device_view.h"

namespace chiaro {

/// Places are in voxels. At a voxel's centre its value is exact.
template <class Voxel>
struct Reader {
    const DeviceVolume::Data& volume;
    kernel::VolumeView<Voxel> view = view_of<Voxel>(volume);

    bool holds(Vec3 p) const {
        const auto within = [&](int axis) { return p[axis] >= -0.5 && p[axis] < volume.dimensions[axis] - 0.5; };
        return within(0) && within(1) && within(2);
    }

    /// The eight voxels from (i, j, k) on.
    auto corners(int i, int j, int k) const {
        const kernel::VoxelIndex<float> first{i, j, k};
        return view.corners(view.locate(kernel::Vec3<float>{float(i), float(j), float(k)}, first));
    }

    /// Of a place that the volume holds.
    double nearest(Vec3 p) const {
        const auto index = [&](int axis) { return int(std::floor(p[axis] + 0.5)); };
        // The last voxel of an axis is the second corner of its last interval.
        std::array<int, 3> first{};
        std::array<bool, 3> second{};
        for (int axis = 0; axis < 3; ++axis) {
            first[axis] = std::clamp(index(axis), 0, std::max(volume.dimensions[axis] - 2, 0));
            second[axis] = index(axis) > first[axis];
        }
        const auto c = corners(first[0], first[1], first[2]);
        const auto& pair = second[2] ? (second[1] ? c.d : c.c) : (second[1] ? c.b : c.a);
        return volume.value_of(second[0] ? pair.b : pair.a);
    }

    /// Outside, the nearest place's.
    double linear(Vec3 p) const {
        std::array<int, 3> first{};
        std::array<double, 3> t{};
        for (int axis = 0; axis < 3; ++axis) {
            const int n = volume.dimensions[axis];
            const double inside = std::clamp(p[axis], 0.0, double(n - 1));
            first[axis] = std::min(int(inside), std::max(n - 2, 0));
            t[axis] = inside - first[axis];
        }
        const auto c = corners(first[0], first[1], first[2]);
        const auto mix = [](double a, double b, double s) { return s == 0 ? a : (1 - s) * a + s * b; };
        const auto along_x = [&](const auto& two) { return mix(two.a, two.b, t[0]); };
        const double near = mix(along_x(c.a), along_x(c.b), t[1]), far = mix(along_x(c.c), along_x(c.d), t[1]);
        return volume.value_of(mix(near, far, t[2]));
    }
};

}  // namespace chiaro

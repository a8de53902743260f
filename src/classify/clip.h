// The clip box and planes as half spaces of the voxel grid.
#pragma once
#include <chiaro/medium.h>

#include <vector>

namespace chiaro {

/// What is kept: normal · p <= d, p in voxel coordinates.
struct HalfSpace {
    Vec3 normal;
    double d;
};
std::vector<HalfSpace> half_spaces(const Clip& clip, const Geometry& geometry, const std::array<int, 3>& dimensions);

}  // namespace chiaro

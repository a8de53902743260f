// The ball around a volume's box.
#pragma once
#include <chiaro/geometry.h>

#include <array>

namespace chiaro {

struct Ball {
    Vec3 centre;
    double radius;  ///< mm
};

inline Ball ball_around(const Geometry& geometry, const std::array<int, 3>& dimensions) {
    const Vec3 span{double(dimensions[0] - 1), double(dimensions[1] - 1), double(dimensions[2] - 1)};
    // An axis of one voxel is one voxel thick: a single slice still has a size.
    const Vec3 thick{std::fmax(span.x, 1), std::fmax(span.y, 1), std::fmax(span.z, 1)};
    const Vec3 diagonal = geometry.world_from_voxel_vector(dimensions == std::array{1, 1, 1} ? thick : span);
    return {geometry.world_from_voxel(0.5 * span), 0.5 * std::fmax(length(diagonal), 1e-30)};
}

}  // namespace chiaro

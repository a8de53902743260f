// Bodies of one value for which the light is known in closed form. Inside 200, outside 0, edges one voxel wide
// (`coverage`); the isosurface 100 is the body's surface.
#include "samples/sample.h"

namespace chiaro {
namespace {

constexpr double inside = 200;

std::uint8_t value_at_depth(double depth, int size) { return std::uint8_t(inside * coverage(depth * size) + 0.5); }

/// 1/4 < z < 3/4; sharp where `size` is a multiple of 4.
SampleVoxels make_slab(int size) {
    return generate<std::uint8_t>([=](int i, int j, int k) {
        const double z = in_unit_cube(i, j, k, size).z;
        return value_at_depth(std::min(z - 0.25, 0.75 - z), size);
    });
}

/// Radius 3/8 of the cube about its centre.
SampleVoxels make_ball(int size) {
    return generate<std::uint8_t>([=](int i, int j, int k) {
        return value_at_depth(0.375 - length(in_unit_cube(i, j, k, size) - Vec3{0.5, 0.5, 0.5}), size);
    });
}

/// z < 1/2; sharp where `size` is even.
SampleVoxels make_halfspace(int size) {
    return generate<std::uint8_t>(
        [=](int i, int j, int k) { return value_at_depth(0.5 - in_unit_cube(i, j, k, size).z, size); });
}

TransferFunction homogeneous(Rgb rgb, double opacity) {
    TransferFunction tf;
    tf.points = {{0, rgb, 0}, {inside, rgb, opacity}};
    return tf;
}

/// Air is clear and the body opaque; between them a ramp about the surface's value, kinder to the eye than a step.
TransferFunction solid(Rgb rgb) {
    TransferFunction tf;
    tf.points = {{inside / 4, rgb, 0}, {inside * 3 / 4, rgb, 1}};
    return tf;
}

TransferFunction slab_transfer_function() { return homogeneous({0.60, 0.80, 1.0}, 0.05); }
TransferFunction ball_transfer_function() { return solid({0.88, 0.54, 0.30}); }
TransferFunction halfspace_transfer_function() { return solid({0.80, 0.80, 0.80}); }

}  // namespace

Sample slab_sample() {
    return {{"slab", "a homogeneous slab, 200 in 1/4 < z < 3/4", 64}, make_slab, slab_transfer_function};
}

Sample ball_sample() {
    return {{"ball", "a homogeneous ball, 200 within 3/8 of the edge length from the centre", 128},
            make_ball,
            ball_transfer_function};
}

Sample halfspace_sample() {
    return {{"halfspace", "a flat open surface, 200 below z = 1/2", 64}, make_halfspace, halfspace_transfer_function};
}

}  // namespace chiaro

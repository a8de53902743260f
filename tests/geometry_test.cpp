#include <chiaro/geometry.h>
#include <gtest/gtest.h>

using namespace chiaro;

TEST(Geometry, VoxelAndWorldAreInverse) {
    Geometry g;
    g.spacing_mm = {0.5, 2, 3};
    g.origin_mm = {-10, 4, 7};
    g.direction = {{normalized({1, 2, 0}), normalized({-2, 1, 0.1}), normalized({0.2, 0, 1})}};
    const Vec3 p{3, -5, 11}, q = g.voxel_from_world(g.world_from_voxel(p));
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(q[axis], p[axis], 1e-12);
}

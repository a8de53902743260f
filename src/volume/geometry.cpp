#include <chiaro/geometry.h>

namespace chiaro {

Vec3 Geometry::world_from_voxel_vector(Vec3 v) const {
    return v.x * spacing_mm.x * direction[0] + v.y * spacing_mm.y * direction[1] + v.z * spacing_mm.z * direction[2];
}

Vec3 Geometry::voxel_from_world_vector(Vec3 v) const {
    const auto& [a, b, c] = direction;
    const double det = dot(a, cross(b, c));  // Cramer's rule; directions need not be orthogonal
    return {dot(v, cross(b, c)) / det / spacing_mm.x, dot(v, cross(c, a)) / det / spacing_mm.y,
            dot(v, cross(a, b)) / det / spacing_mm.z};
}

}  // namespace chiaro

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

Geometry Geometry::in_frame(World other) const {
    Geometry told = *this;
    if (other == world || other == World::unknown || world == World::unknown) return told;
    const auto turn = [](Vec3 v) { return Vec3{-v.x, -v.y, v.z}; };
    told.origin_mm = turn(origin_mm);
    for (Vec3& axis : told.direction) axis = turn(axis);
    told.world = other;
    return told;
}

Vec3 orbit_direction(double azimuth, double elevation, Vec3 up) {
    const Vec3 u = normalized(up);
    const auto is_axis = [](double c) { return std::abs(std::abs(c) - 1) < 1e-12; };
    Vec3 e = is_axis(u.z)          ? Vec3{1, 0, 0}
             : is_axis(u.x)        ? Vec3{0, 1, 0}
             : is_axis(u.y)        ? Vec3{0, 0, 1}
             : std::abs(u.x) > 0.9 ? Vec3{0, 1, 0}
                                   : Vec3{1, 0, 0};
    e = normalized(e - dot(e, u) * u);
    return std::cos(elevation) * (std::cos(azimuth) * e + std::sin(azimuth) * cross(u, e)) + std::sin(elevation) * u;
}

}  // namespace chiaro

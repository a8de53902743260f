// Points, directions and the placement of a voxel grid in the world. Double precision, millimetres.
#pragma once
#include <chiaro/export.h>

#include <array>
#include <cmath>

namespace chiaro {

struct Vec3 {
    double x = 0, y = 0, z = 0;
    double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    bool operator==(const Vec3&) const = default;
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Vec3 a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalized(Vec3 a) { return (1 / length(a)) * a; }

/// The world axes a file speaks in: its own, named, never silently flipped.
enum class World { unknown, lps, ras };

/// World position of voxel (i, j, k) = origin + Σ_a index_a spacing_a direction[a].
struct Geometry {
    Vec3 spacing_mm{1, 1, 1};                                          ///< positive
    Vec3 origin_mm{0, 0, 0};                                           ///< centre of voxel (0, 0, 0)
    std::array<Vec3, 3> direction{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< unit world vector of each index axis
    World world = World::unknown;

    /// Linear part: a displacement in voxels to one in world millimetres.
    CHIARO_EXPORT Vec3 world_from_voxel_vector(Vec3 v) const;
    Vec3 world_from_voxel(Vec3 p_voxel) const { return origin_mm + world_from_voxel_vector(p_voxel); }
    /// Inverses; the direction may be oblique but not singular (checked when a volume is read).
    CHIARO_EXPORT Vec3 voxel_from_world_vector(Vec3 v_mm) const;
    Vec3 voxel_from_world(Vec3 p_mm) const { return voxel_from_world_vector(p_mm - origin_mm); }
    /// The same grid as another frame has it: LPS and RAS point the other way along x and y. An unknown one changes
    /// nothing.
    CHIARO_EXPORT Geometry in_frame(World other) const;
    double smallest_spacing_mm() const { return std::fmin(spacing_mm.x, std::fmin(spacing_mm.y, spacing_mm.z)); }
    bool operator==(const Geometry&) const = default;
};

inline constexpr double radians(double degrees) { return degrees * 3.14159265358979323846 / 180; }

/// Unit vector from the centre to azimuth and elevation (radians) about `up`: for u = up, the azimuth-0 axis e is z→x,
/// x→y, y→z (the same for -u), for other u x, or y where |u_x| > .9, made orthogonal; cos el (cos az e + sin az u×e) +
/// sin el u.
CHIARO_EXPORT Vec3 orbit_direction(double azimuth, double elevation, Vec3 up);

}  // namespace chiaro

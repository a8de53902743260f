// The camera: an orbit around the volume, a named anatomical view, or eye and target.
#pragma once
#include <chiaro/export.h>
#include <chiaro/geometry.h>
#include <chiaro/settings.h>

#include <array>
#include <optional>
#include <string>

namespace chiaro {

enum class Projection { perspective, orthographic };
enum class View { anterior, posterior, left, right, superior, inferior };

/// Angles in degrees: this is the edge of the library.
struct CameraSettings {
    double azimuth_deg = 35, elevation_deg = 25, roll_deg = 0;
    double zoom = 1;
    double fov_deg = 30;     ///< vertical
    std::optional<Vec3> up;  ///< world; +z (superior) if missing
    Projection projection = Projection::perspective;
    std::optional<View> view;         ///< named view: replaces azimuth, elevation and up
    std::optional<Vec3> eye, target;  ///< world mm; both or none: replaces the orbit
    bool operator==(const CameraSettings&) const = default;
};

/// World-space camera, right-handed: forward × up = right.
struct Camera {
    Vec3 eye;                 ///< mm
    Vec3 forward, right, up;  ///< orthonormal
    Projection projection = Projection::perspective;
    double half_height = 0;  ///< tan(fov / 2), or half the height of the view in mm (orthographic)
    Vec3 orbit_up{0, 0, 1};  ///< what azimuth and elevation of lights turn about
    bool operator==(const Camera&) const = default;
};

/// The camera of these settings for a volume. Orbit: c the centre of the span [0, n-1], R half its diagonal,
/// distance zoom⁻¹ R / sin(fov / 2); see docs/scene.md. Throws Error{input} for a named view of a volume without an
/// anatomical frame, Error{usage} for settings that contradict each other or leave no direction.
CHIARO_EXPORT Camera make_camera(const CameraSettings& settings, const Geometry& geometry,
                                 const std::array<int, 3>& dimensions);

}  // namespace chiaro

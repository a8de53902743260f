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

/// What the camera fits: a ball around what is visible (fit_camera, once), or the ball around the volume's box.
enum class Fit { visible, volume };

/// By rows: of homogeneous coordinates, what follows from what stands behind it in the name.
using Matrix4 = std::array<double, 16>;

/// Angles in degrees: this is the edge of the library.
struct CameraSettings {
    double azimuth_deg = 35, elevation_deg = 25, roll_deg = 0;
    double zoom = 1;
    double fov_deg = 30;     ///< vertical
    std::optional<Vec3> up;  ///< world; +z (superior) if missing
    Projection projection = Projection::perspective;
    std::optional<View> view;         ///< named view: replaces azimuth, elevation and up
    std::optional<Vec3> eye, target;  ///< world mm; both or none: replaces the orbit
    std::optional<Matrix4> matrix;    ///< clip from world (camera_of_matrix): replaces all that aims and zooms
    Fit fit = Fit::visible;
    std::optional<Vec3> fit_centre;       ///< of the ball around what is visible, once it was found; world mm ...
    std::optional<double> fit_radius_mm;  ///< ... both or none; none: the volume's
    double aperture_mm = 0;               ///< diameter of the lens; 0: all is sharp
    std::optional<double> focus_mm;       ///< from the eye, along its axis; none: to the ball's centre, or the target
    /// Not a setting: nobody said where to look from, so the volume's frame does (look_from).
    bool by_frame = false;
    bool operator==(const CameraSettings&) const = default;
};

/// World-space camera, right-handed: forward × up = right.
struct Camera {
    Vec3 eye;                 ///< mm
    Vec3 forward, right, up;  ///< orthonormal
    Projection projection = Projection::perspective;
    double half_height = 0;                ///< tan(fov / 2), or half the height of the view in mm (orthographic)
    double half_width = 0;                 ///< the same of the width; 0: as the picture's shape has it
    double centre_x = 0, centre_y = 0;     ///< of the view, along right and up, in the same unit: 0 on the axis
    Vec3 orbit_up{0, 0, 1};                ///< what azimuth and elevation of lights turn about
    double aperture_mm = 0, focus_mm = 1;  ///< diameter of the lens, depth that is in focus
    bool operator==(const Camera&) const = default;
};

/// Azimuth and elevation of a volume's first picture (`by_frame`): where its frame is known, between the front and the
/// patient's left, from a little above; else as they are.
CHIARO_EXPORT void look_from(CameraSettings& settings, World world);

/// The camera of another program: a point of the world in mm is seen where clip_from_world (p, 1) has it, x / w and y /
/// w from -1 at the left and the bottom to 1, as OpenGL does. The view may lie off the axis, as of a tile or an eye of
/// two. Where it is a perspective the near and far planes cut nothing; else rays begin at z = -w, the near plane.
/// `orbit_up` is +z. Throws Error{usage} for a matrix that is singular, mirrors the picture, or shears it: views are
/// rectangles before the eye.
CHIARO_EXPORT Camera camera_of_matrix(const Matrix4& clip_from_world);

/// The camera of these settings for a volume. Orbit: c and R are centre and radius of the ball that the camera fits;
/// distance zoom⁻¹ R / sin(fov / 2); see docs/scene.md. Of a volume c is the centre of the span [0, n-1] and R half its
/// diagonal. Throws Error{input} for a named view of a volume without an
/// anatomical frame, Error{usage} for settings that contradict each other or leave no direction.
CHIARO_EXPORT Camera make_camera(const CameraSettings& settings, const Geometry& geometry,
                                 const std::array<int, 3>& dimensions);

}  // namespace chiaro

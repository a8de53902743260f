// Where the camera stands: orbit, named view, or eye and target.
#include <chiaro/camera.h>
#include <chiaro/error.h>

#include <algorithm>
#include <cmath>

#include "raycast/ball.h"

namespace chiaro {
namespace {

/// The direction of a named view's eye and its up, in the volume's anatomical frame.
struct Anatomy {
    Vec3 to_eye, up;
};

Anatomy anatomy_of(View view, World world) {
    if (world == World::unknown)
        throw Error(
            ErrorCode::input,
            "the volume states no anatomical frame, so it has no named views: use --azimuth, --elevation and --up");
    // LPS: +x left, +y posterior, +z superior; RAS: +x right, +y anterior, +z superior.
    const double sign = world == World::lps ? 1 : -1;
    const Vec3 left{sign, 0, 0}, posterior{0, sign, 0}, superior{0, 0, 1};
    switch (view) {
        case View::anterior:
            return {-posterior, superior};
        case View::posterior:
            return {posterior, superior};
        case View::left:
            return {left, superior};
        case View::right:
            return {-left, superior};
        case View::superior:
            return {superior, -posterior};
        default:
            return {-superior, -posterior};
    }
}

/// Orthonormal axes of a camera that looks along `forward`, `up` as nearly up as that leaves, then rolled.
void aim(Camera& camera, Vec3 forward, Vec3 up, double roll) {
    const Vec3 right = cross(forward, up);
    if (!(length(forward) > 0) || !(length(right) > 1e-9 * length(forward) * length(up)))
        throw Error(
            ErrorCode::usage,
            "the camera looks along its own up direction, or nowhere: choose another --up, --eye or --elevation");
    camera.forward = normalized(forward);
    const Vec3 level = normalized(right), upright = cross(level, camera.forward);
    // Rolling the camera counterclockwise turns the picture clockwise.
    camera.right = std::cos(roll) * level + std::sin(roll) * upright;
    camera.up = cross(camera.right, camera.forward);
}

Ball fitted_ball(const CameraSettings& s, const Geometry& geometry, const std::array<int, 3>& dimensions) {
    if (s.fit == Fit::visible && s.fit_centre && s.fit_radius_mm) return {*s.fit_centre, *s.fit_radius_mm};
    return ball_around(geometry, dimensions);
}

}  // namespace

void look_from(CameraSettings& s, World world) {
    if (!s.by_frame) return;
    s.by_frame = false;
    if (world == World::unknown) return;
    // About +z azimuth 0 is +x. Anterior is -y in LPS, +y in RAS, and left +x and -x.
    constexpr double from_front = 35;
    s.azimuth_deg = world == World::lps ? -90 + from_front : 90 + from_front;
    s.elevation_deg = 15;
}

Camera make_camera(const CameraSettings& settings, const Geometry& geometry, const std::array<int, 3>& dimensions) {
    CameraSettings s = settings;
    if (s.eye.has_value() != s.target.has_value())
        throw Error(ErrorCode::usage, "--eye and --target belong together: give both or neither");
    if (s.matrix && (s.eye || s.view))
        throw Error(ErrorCode::usage, "--camera-matrix replaces --eye and --view: give one of them");
    if (s.eye && s.view) throw Error(ErrorCode::usage, "--eye and --view contradict each other: give one of them");
    look_from(s, geometry.world);
    const auto [centre, radius] = fitted_ball(s, geometry, dimensions);
    Camera camera;
    if (s.matrix) {
        camera = camera_of_matrix(*s.matrix);
        camera.aperture_mm = s.aperture_mm;
        camera.orbit_up = s.up.value_or(Vec3{0, 0, 1});
        camera.focus_mm = s.focus_mm.value_or(std::max(dot(centre - camera.eye, camera.forward), 1e-6));
        return camera;
    }
    camera.projection = s.projection;
    camera.aperture_mm = s.aperture_mm;
    const double half_fov = radians(s.fov_deg) / 2;
    camera.half_height = s.projection == Projection::perspective ? std::tan(half_fov) : radius / s.zoom;
    Vec3 up = s.up.value_or(Vec3{0, 0, 1});
    if (!(length(up) > 0) || !std::isfinite(length(up)))
        throw Error(ErrorCode::usage, "--up must point somewhere: an axis such as -z, or X,Y,Z other than 0,0,0");
    if (s.eye) {
        camera.eye = *s.eye;
        camera.orbit_up = up;
        aim(camera, *s.target - *s.eye, up, radians(s.roll_deg));
        camera.focus_mm = s.focus_mm.value_or(length(*s.target - *s.eye));
        return camera;
    }
    Vec3 to_eye;
    if (s.view) {
        const Anatomy anatomy = anatomy_of(*s.view, geometry.world);
        to_eye = anatomy.to_eye;
        up = anatomy.up;
        camera.orbit_up = s.up.value_or(Vec3{0, 0, 1});
    } else {
        to_eye = orbit_direction(radians(s.azimuth_deg), radians(s.elevation_deg), up);
        camera.orbit_up = up;
        // Straight above or below, any level direction will do: the limit of the orbit keeps the picture from turning.
        if (length(cross(to_eye, normalized(up))) < 1e-9)
            up = -std::copysign(1.0, s.elevation_deg) * orbit_direction(radians(s.azimuth_deg), 0, up);
    }
    const double distance = radius / (s.zoom * std::sin(half_fov));
    camera.eye = centre + distance * to_eye;
    camera.focus_mm = s.focus_mm.value_or(distance);
    aim(camera, -to_eye, up, radians(s.roll_deg));
    return camera;
}

}  // namespace chiaro

// The camera that a matrix of another program stands for.
#include <chiaro/camera.h>
#include <chiaro/error.h>

#include <cmath>

#include "core/linear_system.h"

namespace chiaro {
namespace {

constexpr double negligible = 1e-6;  // of lengths and cosines: matrices may have been single precision

struct Column {
    Vec3 p;
    double w;
};

[[noreturn]] void refuse(const char* what) {
    throw Error(ErrorCode::usage, std::string("the camera's matrix ") + what);
}

/// World from clip coordinates.
std::array<Column, 4> columns_of_inverse(const Matrix4& m) {
    std::vector<std::vector<double>> rows(4, std::vector<double>(4));
    for (std::size_t i = 0; i < 16; ++i) rows[i / 4][i % 4] = m[i];
    std::array<Column, 4> columns;
    for (std::size_t c = 0; c < 4; ++c) {
        std::vector<double> unit(4, 0.0);
        unit[c] = 1;
        const auto x = solve(rows, unit);
        for (double value : x)
            if (!std::isfinite(value)) refuse("is singular: it leaves no way back from the picture to the world");
        columns[c] = {{x[0], x[1], x[2]}, x[3]};
    }
    return columns;
}

/// Turns the view's axes - half its width and half its height, as vectors - into those of a camera. `ahead`: where
/// along the axis they are seen at that size.
void set_axes(Camera& camera, Vec3 across, Vec3 upwards, double ahead) {
    camera.half_width = length(across) / ahead, camera.half_height = length(upwards) / ahead;
    camera.up = normalized(upwards);
    camera.right = cross(camera.forward, camera.up);
    const Vec3 right = normalized(across);
    if (dot(right, camera.right) < 0) refuse("mirrors the picture");
    if (!(length(right - camera.right) < negligible))
        refuse("shears the picture: a view is a rectangle before the eye");
}

}  // namespace

Camera camera_of_matrix(const Matrix4& m) {
    // Rows: x, y, z, w of clip space. A point of the picture is seen along all points with its x / w and y / w.
    const Vec3 w_row{m[12], m[13], m[14]};
    const auto [x, y, z, middle] = columns_of_inverse(m);
    Camera camera;
    if (length(w_row) <= 1e-12 * std::abs(m[15])) {
        const double scale = 1 / middle.w;  // the same for all points
        camera.projection = Projection::orthographic;
        camera.forward = normalized(scale * z.p);
        camera.eye = scale * (middle.p - z.p);
        set_axes(camera, scale * x.p, scale * y.p, 1);
        return camera;
    }
    // The eye is seen nowhere: x = y = w = 0. From there to the picture's points with w = 1, linear in x and y.
    camera.eye = (1 / z.w) * z.p;
    const auto from_eye = [&](const Column& c) { return c.p - c.w * camera.eye; };
    const Vec3 ahead = from_eye(middle);
    camera.forward = normalized(w_row);
    const double distance = dot(ahead, camera.forward);
    set_axes(camera, from_eye(x), from_eye(y), distance);
    camera.centre_x = dot(ahead, camera.right) / distance, camera.centre_y = dot(ahead, camera.up) / distance;
    return camera;
}

}  // namespace chiaro

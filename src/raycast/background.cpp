#include "raycast/background.h"

#include <algorithm>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/probe/data.h"
#include "illumination/probe/light.h"

namespace chiaro {
namespace {

using Rgbf = std::array<float, 3>;

/// Between pixel centres bilinear, around the azimuth without an end; up and down the outermost rows go on.
Rgbf radiance_at(const ProbePicture& picture, Vec3 d) {
    const auto [x, y] = picture.place(d);
    const double left = std::floor(x - 0.5), above = std::floor(y - 0.5);
    const float along = float(x - 0.5 - left), down = float(y - 0.5 - above);
    const auto column = [&](double c) { return int(c < 0 ? c + picture.width : c < picture.width ? c : 0); };
    const auto row = [&](double r) { return std::clamp(int(r), 0, picture.height - 1); };
    const auto pixel = [&](int i, int j) { return picture.rgb.data() + 3 * (std::size_t(j) * picture.width + i); };
    const int i0 = column(left), i1 = column(left + 1), j0 = row(above), j1 = row(above + 1);
    Rgbf rgb;
    for (int c = 0; c < 3; ++c) {
        const float near = pixel(i0, j0)[c] + along * (pixel(i1, j0)[c] - pixel(i0, j0)[c]);
        const float far = pixel(i0, j1)[c] + along * (pixel(i1, j1)[c] - pixel(i0, j1)[c]);
        rgb[c] = near + down * (far - near);
    }
    return rgb;
}

/// The directions of a camera's pixels in the probe's own frame; see CameraView::ray.
struct Rays {
    Vec3 first, right, down;  ///< towards pixel (0, 0), and from pixel to pixel; not normalised

    Rays(const Camera& camera, const Lighting& lighting, const Frame& frame) {
        const Axes probe = transposed(world_from_probe(lighting.probe.rotation_deg, camera.orbit_up));
        first = turned(probe, camera.forward);
        if (camera.projection == Projection::orthographic) return;
        const double pixel = 2 * camera.half_height / frame.height;
        right = pixel * turned(probe, camera.right);
        down = -pixel * turned(probe, camera.up);
        first = first - (0.5 * frame.width - 0.5) * right - (0.5 * frame.height - 0.5) * down;
    }
    Vec3 towards(int x, int y) const { return first + double(x) * right + double(y) * down; }
};

}  // namespace

bool put_probe_behind(const Device& device, const Lighting& lighting, const Camera& camera, ColorMode color,
                      Frame& frame, Progress& progress) {
    const Probe probe = lighting_probe(lighting);
    const Rays rays(camera, lighting, frame);
    const float gain = float(std::exp2(lighting.probe.exposure_stops));
    const auto fill_row = [&](std::int64_t y, std::int64_t) {
        float* pixel = frame.rgba.data() + std::size_t(4) * frame.width * y;
        for (int x = 0; x < frame.width; ++x, pixel += 4) {
            const float open = 1 - pixel[3];
            pixel[3] = 1;
            if (!(open > 0)) continue;
            const Rgbf light = radiance_at(probe.data().picture, rays.towards(x, int(y)));
            for (int c = 0; c < 3; ++c)
                pixel[c] += open * (color == ColorMode::linear ? gain * light[c]
                                                               : float(srgb_from_linear(double(gain * light[c]))));
        }
    };
    return parallel_for(device.threads, frame.height, 1, "background", progress, fill_row);
}

}  // namespace chiaro

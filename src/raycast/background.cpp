#include "raycast/background.h"

#include <algorithm>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/probe/data.h"
#include "illumination/probe/light.h"

namespace chiaro {
namespace {

using Rgbf = std::array<float, 3>;

/// atan2 in turns, [-½, ½], within 1e-7: the polynomial 4.4.49 of Abramowitz and Stegun. Every pixel needs two.
inline float turns(float y, float x) {
    const float across = std::abs(y), along = std::abs(x), more = std::max(across, along);
    const float t = std::min(across, along) / std::max(more, 1e-30f), q = t * t, qq = q * q;
    // In pairs of terms, which a processor finds side by side.
    const float ends = (0.0429096138f - 0.0161657367f * q) + 0.0028662257f * qq;
    const float middle = (0.1065626393f - 0.0752896400f * q) + ends * qq;
    const float series = (1 - 0.3333314528f * q) + ((0.1999355085f - 0.1420889944f * q) + middle * qq) * qq;
    float angle = t * series * float(0.5 / std::numbers::pi);
    angle = across > along ? 0.25f - angle : angle;
    angle = x < 0 ? 0.5f - angle : angle;
    return y < 0 ? -angle : angle;
}

/// Between pixel centres bilinear, around the azimuth without an end; up and down the outermost rows go on.
Rgbf radiance_at(const ProbePicture& picture, Vec3 d) {
    const float dx = float(d.x), dy = float(d.y), dz = float(d.z);
    const float x = (0.5f - turns(dy, dx)) * float(picture.width);  // as ProbePicture::place
    const float y = 2 * turns(std::sqrt(dx * dx + dy * dy), dz) * float(picture.height);
    const int left = int(x + 0.5f) - 1, above = int(y + 0.5f) - 1;
    const float along = x - 0.5f - float(left), down = y - 0.5f - float(above);
    const auto column = [&](int c) { return c < 0 ? c + picture.width : c < picture.width ? c : c - picture.width; };
    const auto row = [&](int r) { return std::clamp(r, 0, picture.height - 1); };
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

#include "illumination/probe/lights.h"

#include <chiaro/camera.h>
#include <chiaro/error.h>

#include <cmath>

#include "core/srgb.h"
#include "illumination/probe/data.h"

namespace chiaro {

Probe probe_of_lights(const std::vector<Light>& lights) {
    const auto refuse = [](const char* what) { throw Error(ErrorCode::usage, std::string("probe lights: ") + what); };
    if (lights.empty()) refuse("there is none; --light AZ,EL adds one");
    for (const Light& light : lights) {
        if (light.position_mm) refuse("a light at a point comes from no one direction; --light AZ,EL does");
        if (light.headlight) refuse("a headlight turns with the camera; --light AZ,EL is fixed to the world");
    }
    // L = c κ/2 exp(κ (cos - 1)), of which ∫ L dω / π = c.
    constexpr double sharpness = 400, height = 512;
    ProbeImage image{2 * int(height), int(height), {}};
    image.rgb.resize(std::size_t(3) * image.width * image.height);
    for (const Light& light : lights) {
        const Vec3 direction = orbit_direction(radians(light.azimuth_deg), radians(light.elevation_deg), {0, 0, 1});
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const double away = 1 - dot(direction, image.direction(x + 0.5, y + 0.5));
                if (sharpness * away > 20) continue;
                const double shown = sharpness / 2 * std::exp(-sharpness * away);
                float* to = image.rgb.data() + 3 * (std::size_t(y) * image.width + x);
                for (int c = 0; c < 3; ++c) to[c] += float(shown * linear_from_srgb(light.color[std::size_t(c)]));
            }
    }
    return Probe(image.width, image.height, std::move(image.rgb));
}

}  // namespace chiaro

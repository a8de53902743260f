// What stands behind a Probe. Its own frame: z = up, x = azimuth 0, y = azimuth 90°.
#pragma once
#include <chiaro/probe.h>

#include <cmath>
#include <numbers>

#include "illumination/sh/rotation.h"

namespace chiaro {

/// Red, green and blue weigh so much in luminance (Rec. 709).
inline constexpr std::array<double, 3> luminance_weights{0.2126, 0.7152, 0.0722};

struct ProbePicture {
    int width = 0, height = 0;
    std::vector<float> rgb;  ///< finite, not negative

    /// Azimuth at x pixels from the left, angle from up at y pixels from the top; pixel centres at + ½.
    double azimuth(double x) const { return 2 * std::numbers::pi * (0.5 - x / width); }
    double polar_angle(double y) const { return std::numbers::pi * y / height; }
    Vec3 direction(double x, double y) const {
        const double phi = azimuth(x), theta = polar_angle(y);
        return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    }
};

/// L_lm of each channel: L constant in each pixel, integrated exactly, weighted by solid angle and nothing else. As
/// Y_lm = P(θ) cos mφ (m >= 0) or P(θ) sin |m|φ, a row needs the sums of its pixels times cos mφ and sin mφ alone. The
/// same for any number of threads.
std::array<ShCoefficients, 3> project(const ProbePicture& picture);

struct Probe::Data {
    ProbePicture picture;
    std::array<ShCoefficients, 3> sh;  ///< per channel
};

}  // namespace chiaro

// What stands behind a Probe. Its own frame: z = up, x = azimuth 0, y = azimuth 90°.
#pragma once
#include <chiaro/probe.h>

#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>

#include "core/lazy.h"
#include "core/srgb.h"
#include "illumination/probe/dominant.h"
#include "illumination/probe/highlight.h"
#include "illumination/probe/lambert.h"
#include "illumination/sh/rotation.h"

namespace chiaro {

struct ProbeImage {
    int width = 0, height = 0;
    std::vector<float> rgb;  ///< finite, not negative

    /// Azimuth at x pixels from the left, angle from up at y pixels from the top; pixel centres at + ½.
    double azimuth(double x) const { return 2 * std::numbers::pi * (0.5 - x / width); }
    double polar_angle(double y) const { return std::numbers::pi * y / height; }
    Vec3 direction(double x, double y) const {
        const double phi = azimuth(x), theta = polar_angle(y);
        return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    }

    struct Place {
        double x, y;  ///< pixels, [0, width] and [0, height]
    };
    /// Where a direction of any length is seen.
    Place place(Vec3 d) const {
        const double s = 0.5 - std::atan2(d.y, d.x) / (2 * std::numbers::pi);
        return {s * width, std::atan2(std::hypot(d.x, d.y), d.z) / std::numbers::pi * height};
    }
    /// Of each pixel in a row.
    double solid_angle(int y) const {
        return 2 * std::numbers::pi / width * (std::cos(polar_angle(y)) - std::cos(polar_angle(y + 1)));
    }
};

/// L_lm of each channel: L constant in each pixel, integrated exactly, weighted by solid angle and nothing else. As
/// Y_lm = P(θ) cos mφ (m >= 0) or P(θ) sin |m|φ, a row needs the sums of its pixels times cos mφ and sin mφ alone. The
/// same for any number of threads.
std::array<ShCoefficients, 3> project(const ProbeImage& image);

struct Probe::Data : std::enable_shared_from_this<Data> {
    explicit Data(ProbeImage of) : image(std::move(of)), sh(project(image)) {}

    const ProbeImage image;
    const std::array<ShCoefficients, 3> sh;  ///< per channel
    const LambertTable& lambert() const {
        return lambert_([&] { return lambert_of_probe(*this); });
    }

    /// What ProbeExposure's auto is for this probe.
    double suitable_stops() const {
        return suitable_stops_([&] { return suitable_stops_of_probe(*this); });
    }

    const ProbePieces& pieces() const {
        return pieces_([&] { return pieces_of_probe(*this); });
    }

    /// The last one is kept.
    std::shared_ptr<const Highlight> highlight(const HighlightKey& key) const;

    /// The same light above an open floor of that albedo (illumination/floor); the last one is kept.
    Probe above_floor(double albedo) const;

private:
    struct LastFloor {
        std::mutex mutex;
        std::optional<double> albedo;
        Probe probe;
    };
    struct LastHighlight {
        std::mutex mutex;
        std::shared_ptr<const Highlight> last;
    };
    mutable LastFloor floor_;
    mutable LastHighlight highlight_;
    Lazy<LambertTable> lambert_;
    Lazy<ProbePieces> pieces_;
    Lazy<double> suitable_stops_;
};

}  // namespace chiaro

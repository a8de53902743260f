#include <chiaro/error.h>

#include <algorithm>
#include <cmath>

#include "render/mixed_settings.h"

namespace chiaro {
namespace {

/// Cubic Hermite through the values at the times, with Catmull and Rom's tangents: through evenly spaced values of a
/// line it is the line.
double on_curve(const std::vector<double>& times, const std::vector<double>& values, std::size_t i, double seconds) {
    const std::size_t last = values.size() - 1;
    const auto tangent = [&](std::size_t k) {
        const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, last);
        return (values[after] - values[before]) / (times[after] - times[before]);
    };
    const double h = times[i + 1] - times[i], s = (seconds - times[i]) / h, s2 = s * s, s3 = s2 * s;
    return (2 * s3 - 3 * s2 + 1) * values[i] + (s3 - 2 * s2 + s) * h * tangent(i) + (3 * s2 - 2 * s3) * values[i + 1] +
           (s3 - s2) * h * tangent(i + 1);
}

/// Turns of at most half a circle from each angle to the next.
std::vector<double> unwound(std::vector<double> degrees) {
    for (std::size_t i = 1; i < degrees.size(); ++i)
        degrees[i] = degrees[i - 1] + std::remainder(degrees[i] - degrees[i - 1], 360.0);
    return degrees;
}

class Path {
public:
    Path(const std::vector<double>& times, const std::vector<const Scene*>& scenes, double seconds)
        : times_(times), scenes_(scenes), seconds_(std::clamp(seconds, times.front(), times.back())) {
        while (i_ + 2 < times_.size() && times_[i_ + 1] <= seconds_) ++i_;
    }

    std::size_t segment() const { return i_; }
    double share() const { return (seconds_ - times_[i_]) / (times_[i_ + 1] - times_[i_]); }
    std::size_t count() const { return scenes_.size(); }
    const CameraSettings& key(std::size_t k) const { return scenes_[k]->camera; }

    double at(const std::vector<double>& values) const { return on_curve(times_, values, i_, seconds_); }
    template <class Get>
    std::vector<double> values(const Get& get) const {
        std::vector<double> all;
        for (std::size_t k = 0; k < count(); ++k) all.push_back(get(k));
        return all;
    }
    template <class Get>
    double number(const Get& get) const {
        return at(values(get));
    }
    /// Of what is above 0: even in its logarithm.
    template <class Get>
    double size(const Get& get) const {
        return std::exp(number([&](std::size_t k) { return std::log(get(k)); }));
    }
    template <class Get>
    Vec3 point(const Get& get) const {
        Vec3 p;
        for (int axis = 0; axis < 3; ++axis) p[axis] = number([&](std::size_t k) { return get(k)[axis]; });
        return p;
    }
    template <class Is>
    bool all(const Is& is) const {
        for (std::size_t k = 0; k < count(); ++k)
            if (!is(key(k))) return false;
        return true;
    }

private:
    const std::vector<double>& times_;
    const std::vector<const Scene*>& scenes_;
    double seconds_;
    std::size_t i_ = 0;
};

/// The shorter way round between two directions.
Vec3 turned(Vec3 a, Vec3 b, double t) {
    const double angle = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
    if (angle < 1e-9) return a;
    if (angle > 3.14159) return t < 0.5 ? a : b;  // opposite: there is no shorter way
    return (1 / std::sin(angle)) * (std::sin((1 - t) * angle) * a + std::sin(t * angle) * b);
}

void place_eye(const Path& path, const Geometry& geometry, const std::array<int, 3>& dimensions,
               CameraSettings& camera) {
    std::vector<Vec3> targets, offsets;
    for (std::size_t k = 0; k < path.count(); ++k) {
        const Camera seen = make_camera(path.key(k), geometry, dimensions);
        const auto [nx, ny, nz] = dimensions;
        const Vec3 middle = geometry.world_from_voxel({0.5 * (nx - 1), 0.5 * (ny - 1), 0.5 * (nz - 1)});
        targets.push_back(path.key(k).target.value_or(path.key(k).fit_centre.value_or(middle)));
        offsets.push_back(seen.eye - targets.back());
    }
    const Vec3 target = path.point([&](std::size_t k) { return targets[k]; });
    const double distance = path.size([&](std::size_t k) { return std::max(length(offsets[k]), 1e-9); });
    const std::size_t i = path.segment();
    camera.target = target;
    camera.eye = target + distance * turned(normalized(offsets[i]), normalized(offsets[i + 1]), path.share());
    camera.view.reset();
}

}  // namespace

CameraSettings camera_on_path(const std::vector<double>& times, const std::vector<const Scene*>& scenes,
                              const Geometry& geometry, const std::array<int, 3>& dimensions, double seconds) {
    if (scenes.size() == 1) return scenes.front()->camera;
    const Path path(times, scenes, seconds);
    if (path.share() <= 0) return path.key(path.segment());  // a key's own, to the last bit
    if (path.share() >= 1) return path.key(path.segment() + 1);
    CameraSettings camera = path.key(path.segment());
    const auto key = [&](std::size_t k) -> const CameraSettings& { return path.key(k); };
    camera.roll_deg = path.at(unwound(path.values([&](std::size_t k) { return key(k).roll_deg; })));
    camera.zoom = path.size([&](std::size_t k) { return key(k).zoom; });
    camera.fov_deg = std::clamp(path.number([&](std::size_t k) { return key(k).fov_deg; }), 0.1, 170.0);
    camera.aperture_mm = std::max(0.0, path.number([&](std::size_t k) { return key(k).aperture_mm; }));
    if (path.all([](const CameraSettings& c) { return c.focus_mm.has_value(); }))
        camera.focus_mm = path.size([&](std::size_t k) { return *key(k).focus_mm; });
    if (path.all([](const CameraSettings& c) { return c.fit_centre && c.fit_radius_mm; })) {
        camera.fit_centre = path.point([&](std::size_t k) { return *key(k).fit_centre; });
        camera.fit_radius_mm = path.size([&](std::size_t k) { return *key(k).fit_radius_mm; });
    }
    if (path.all([](const CameraSettings& c) { return !c.eye && !c.view; })) {
        camera.azimuth_deg = path.at(unwound(path.values([&](std::size_t k) { return key(k).azimuth_deg; })));
        camera.elevation_deg =
            std::clamp(path.number([&](std::size_t k) { return key(k).elevation_deg; }), -90.0, 90.0);
    } else {
        place_eye(path, geometry, dimensions, camera);
    }
    return camera;
}

}  // namespace chiaro

// The ball that a camera fits: found by looking, at small pictures without light.
#include <chiaro/render.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "classify/medium.h"
#include "raycast/ball.h"

namespace chiaro {
namespace {

constexpr double least_opacity = 0.06;  // of a ray that counts: a pixel of .1 may be a part of a small one
constexpr double filled = 0.91;         // of the picture's width or height
constexpr double settled = 0.01;        // shares of half the picture
constexpr int long_side = 192;          // pixels: thin ends that rays miss are shorter than the margin
constexpr int max_rounds = 8, turns = 12;

/// Of what is seen, in shares of half the picture from its middle.
struct Extent {
    double left = 2, right = -2, bottom = 2, top = -2;

    bool is_empty() const { return left > right; }
    bool is_cut() const { return left <= -1 || right >= 1 || bottom <= -1 || top >= 1; }
};

Extent extent_of(const Frame& frame) {
    int left = frame.width, right = -1, top = frame.height, bottom = -1;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            if (frame.rgba[4 * (std::size_t(y) * frame.width + x) + 3] < least_opacity) continue;
            left = std::min(left, x), right = std::max(right, x);
            top = std::min(top, y), bottom = std::max(bottom, y);
        }
    if (right < 0) return {};
    const auto across = [&](int column) { return 2.0 * column / frame.width - 1; };
    const auto upwards = [&](int row) { return 1 - 2.0 * row / frame.height; };
    return {across(left), across(right + 1), upwards(bottom + 1), upwards(top)};
}

/// The least x of all that solve A x = b, A symmetric and perhaps singular: A = Σ r rᵀ + u uᵀ.
struct NormalEquations {
    Vec3 rows[3]{{1e-9, 0, 0}, {0, 1e-9, 0}, {0, 0, 1e-9}}, right_side;

    void add(Vec3 axis, double value) {
        for (int i = 0; i < 3; ++i) rows[i] = rows[i] + axis[i] * axis;
        right_side = right_side + value * axis;
    }
    Vec3 solution() const {
        const Vec3 yz = cross(rows[1], rows[2]), zx = cross(rows[2], rows[0]), xy = cross(rows[0], rows[1]);
        return (1 / dot(rows[0], yz)) * (right_side.x * yz + right_side.y * zx + right_side.z * xy);
    }
};

/// What one camera sees, and how long half the picture is at the ball's centre.
struct Seen {
    Camera camera;
    Extent extent;
    double half_width_mm, half_height_mm;

    double farthest(Vec3 moved_mm) const {
        const double x = dot(moved_mm, camera.right) / half_width_mm, y = dot(moved_mm, camera.up) / half_height_mm;
        return std::max({x - extent.left, extent.right - x, y - extent.bottom, extent.top - y});
    }
};

class Search {
public:
    Search(const Device& device, const Medium& medium, const CameraSettings& camera, const RaySettings& rays, int width,
           int height)
        : device_(device), medium_(medium), geometry_(medium.data().volume.geometry()), camera_(camera), rays_(rays) {
        const double scale = double(long_side) / std::max(width, height);
        frame_ = Frame(std::max(1, int(std::lround(scale * width))), std::max(1, int(std::lround(scale * height))));
        camera_.zoom = 1;
        camera_.aperture_mm = 0;
        camera_.fit = Fit::visible;
        rays_.samples_per_pixel = 1;
        rays_.ends = nullptr;
        rays_.compositing = Compositing::front_to_back;
        rays_.early_termination = 1 - least_opacity;
        start();
    }

    /// False where nothing is seen.
    bool find(bool all_around, Progress& progress) {
        for (int round = 0; round < max_rounds; ++round) {
            std::vector<Seen> all;
            for (const Camera& camera : views(all_around, round == 0)) all.push_back(look(camera, progress));
            const auto is_empty = [](const Seen& seen) { return seen.extent.is_empty(); };
            if (std::all_of(all.begin(), all.end(), is_empty)) return false;
            std::erase_if(all, is_empty);
            if (follow(all, round < 3 ? 1 : 0.6) && (round > 0 || all_around)) break;
        }
        return true;
    }

    Ball ball() const { return {*camera_.fit_centre, *camera_.fit_radius_mm}; }

private:
    /// The volume's ball, from so far that the picture holds it in both directions.
    void start() {
        const Ball whole = ball_around(geometry_, medium_.data().volume.dimensions());
        const double narrow = std::min(1.0, double(frame_.width) / frame_.height), half = radians(camera_.fov_deg) / 2;
        const bool is_flat = camera_.projection == Projection::orthographic;
        const double factor = is_flat ? 1 / narrow : std::sin(half) / std::sin(std::atan(narrow * std::tan(half)));
        camera_.fit_centre = whole.centre, camera_.fit_radius_mm = factor * whole.radius;
    }

    /// At first from the side as well, so that the ball lies in the depth of what is seen.
    std::vector<Camera> views(bool all_around, bool is_first) const {
        std::vector<Camera> cameras;
        CameraSettings turned = camera_;
        for (int turn = 0; turn < (all_around ? turns : 1); ++turn) {
            turned.azimuth_deg = camera_.azimuth_deg + 360.0 * turn / turns;
            cameras.push_back(make_camera(turned, geometry_, medium_.data().volume.dimensions()));
        }
        if (!is_first || all_around || camera_.eye) return cameras;
        Camera side = cameras.front();
        std::swap(side.forward, side.right);
        side.forward = -side.forward;
        side.eye = *camera_.fit_centre - length(cameras.front().eye - *camera_.fit_centre) * side.forward;
        cameras.push_back(side);
        return cameras;
    }

    Seen look(const Camera& camera, Progress& progress) {
        Lighting plain;
        plain.shading = Shading::none;
        raycast(device_, medium_, IlluminationField(), plain, camera, rays_, frame_, progress);
        progress.check();
        const double depth =
            camera.projection == Projection::orthographic ? 1 : dot(*camera_.fit_centre - camera.eye, camera.forward);
        const double half_height_mm = camera.half_height * depth;
        return {camera, extent_of(frame_), half_height_mm * frame_.width / frame_.height, half_height_mm};
    }

    /// Moves the ball to the middle of what is seen - a share of the way, for in wide views what lies near the eye
    /// would swing to and fro - and makes it as large as the view that needs most asks for. True where little has
    /// changed.
    bool follow(const std::vector<Seen>& all, double share) {
        if (std::any_of(all.begin(), all.end(), [](const Seen& seen) { return seen.extent.is_cut(); }))
            return resize(1.5), false;
        NormalEquations middle;
        double aside = 0;
        for (const auto& [camera, extent, half_width_mm, half_height_mm] : all) {
            const double x = (extent.left + extent.right) / 2, y = (extent.bottom + extent.top) / 2;
            middle.add(camera.right, x * half_width_mm), middle.add(camera.up, y * half_height_mm);
            aside = std::max({aside, std::abs(x), std::abs(y)});
        }
        const Vec3 moved_mm = camera_.eye ? Vec3{} : share * middle.solution();
        double farthest = 0;
        for (const Seen& seen : all) farthest = std::max(farthest, seen.farthest(moved_mm));
        *camera_.fit_centre = *camera_.fit_centre + moved_mm;
        resize(farthest / filled);
        return std::abs(farthest / filled - 1) < settled && (aside < settled || all.size() > 1);
    }

    /// What lies before the centre grows faster than the picture's scale, so a step may be too long: then it ends half
    /// way to the last radius that was too small or too large.
    void resize(double factor) {
        double& radius = *camera_.fit_radius_mm;
        if (std::abs(factor - 1) > settled) (factor > 1 ? too_small_ : too_large_) = radius;
        radius *= factor;
        if (radius < too_small_ || radius > too_large_) radius = std::sqrt(too_small_ * too_large_);
    }

    const Device& device_;
    const Medium& medium_;
    const Geometry& geometry_;
    double too_small_ = 1e-30, too_large_ = 1e30;  // radii, mm
    CameraSettings camera_;
    RaySettings rays_;
    Frame frame_;
};

}  // namespace

CameraSettings fit_camera(const Device& device, const Medium& medium, const CameraSettings& camera,
                          const RaySettings& rays, int width, int height, Progress& progress, bool all_around) {
    CameraSettings fitted = camera;
    look_from(fitted, medium.data().volume.geometry().world);
    const bool is_placed = fitted.matrix || (fitted.eye && fitted.projection == Projection::perspective);
    if (fitted.fit == Fit::volume || fitted.fit_centre || is_placed) return fitted;
    Search search(device, medium, fitted, rays, width, height);
    if (search.find(all_around, progress)) {
        const auto [centre, radius] = search.ball();
        fitted.fit_centre = centre, fitted.fit_radius_mm = radius;
    }
    return fitted;
}

}  // namespace chiaro

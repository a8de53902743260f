// Probes as functions of direction: nothing need be shipped.
#include <chiaro/error.h>
#include <chiaro/transfer_function.h>
#include <fmt/format.h>

#include <algorithm>

#include "core/did_you_mean.h"
#include "core/threads.h"
#include "illumination/probe/data.h"
#include "illumination/probe/lights.h"

namespace chiaro {
namespace {

constexpr double degree = std::numbers::pi / 180;

Rgb operator*(double s, Rgb c) { return {s * c[0], s * c[1], s * c[2]}; }
Rgb operator+(Rgb a, Rgb b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Rgb mix(Rgb a, Rgb b, double share) { return (1 - share) * a + share * b; }

/// 0 below `low`, 1 above `high`, smooth between.
double rise(double x, double low, double high) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

Vec3 towards(double azimuth_deg, double elevation_deg) {
    const double a = azimuth_deg * degree, e = elevation_deg * degree;
    return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

Rgb white(Vec3) { return {1, 1, 1}; }

/// Blue above, warm towards the horizon and the sun, which is soft: a lobe exp(κ (cos - 1)) some 4° wide. Dull ground.
Rgb sky(Vec3 d) {
    static const Vec3 sun = towards(-25, 38);
    const double near_sun = dot(d, sun), height = std::max(d.z, 0.0), depth = std::max(-d.z, 0.0);
    const Rgb air = mix({0.10, 0.27, 0.62}, {0.66, 0.57, 0.42}, std::exp(-8 * height)) +
                    0.4 * std::pow(std::max(near_sun, 0.0), 16) * Rgb{1, 0.72, 0.42};
    const Rgb ground = mix({0.10, 0.085, 0.07}, {0.30, 0.25, 0.20}, std::exp(-5 * depth));
    return mix(ground, air, rise(d.z, -0.02, 0.02)) + 300 * std::exp(400 * (near_sun - 1)) * Rgb{1, 0.86, 0.66};
}

/// A rectangle of light that faces the centre, seen through the plane at distance 1: soft edges, brighter in the
/// middle.
double soft_box(Vec3 d, double azimuth_deg, double elevation_deg, double half_width, double half_height) {
    const Vec3 centre = towards(azimuth_deg, elevation_deg), right = towards(azimuth_deg + 90, 0);
    const double facing = dot(d, centre);
    if (facing <= 0) return 0;
    const double x = std::abs(dot(d, right) / facing) / half_width;
    const double y = std::abs(dot(d, cross(centre, right)) / facing) / half_height;
    const double inside = (1 - rise(x, 0.94, 1.06)) * (1 - rise(y, 0.94, 1.06));
    return inside * (1 - 0.3 * std::min(x * x + y * y, 2.0));
}

/// In a dark room a large warm soft box high on one side, and a narrow cool one low on the other.
Rgb studio(Vec3 d) {
    const Rgb room = (0.012 + 0.01 * (1 + d.z)) * Rgb{1, 0.98, 0.95};
    return room + 14 * soft_box(d, -25, 38, 0.5, 0.38) * Rgb{1, 0.84, 0.64} +
           7 * soft_box(d, 112, 12, 0.22, 0.62) * Rgb{0.58, 0.79, 1};
}

/// A portrait's three lights in a dark room: a large warm-white key from the left of the default camera, a weaker and
/// larger fill from its right at eye level, and a narrow bright rim from behind and above, which lifts the outline off
/// a black ground; a soft floor and ceiling keep shadows open on grey and white.
Rgb three_point(Vec3 d) {
    const Rgb room = (0.10 + 0.07 * d.z) * Rgb{0.95, 0.98, 1};
    return room + 11 * soft_box(d, -15, 42, 0.42, 0.42) * Rgb{1, 0.95, 0.88} +
           1.7 * soft_box(d, 95, 8, 0.75, 0.60) * Rgb{0.86, 0.93, 1} +
           16 * soft_box(d, 200, 38, 0.16, 0.50) * Rgb{0.95, 0.98, 1};
}

/// Six tall windows with round tops and bars around a dark room.
Rgb windows(Vec3 d) {
    static constexpr Rgb glass[6] = {{1.00, 0.015, 0.01}, {1.00, 0.38, 0.01}, {0.04, 0.75, 0.06},
                                     {0.015, 0.50, 1.00}, {0.03, 0.03, 1.00}, {1.00, 0.02, 0.42}};
    const double turn = std::atan2(d.y, d.x) / (60 * degree), place = std::floor(turn + 0.5);
    const double x = std::tan((turn - place) * 60 * degree), y = d.z / std::hypot(d.x, d.y) * std::sqrt(1 + x * x);
    // On the flat wall: a panel from -.3 to .65 under a half disc, both .3 to each side.
    const double half = 0.3, top = 0.65, bottom = -0.3, edge = 0.012;
    const double beyond = y > top ? std::hypot(x, y - top) : std::abs(x);
    const double opening = (1 - rise(beyond, half - edge, half + edge)) * rise(y, bottom - edge, bottom + edge);
    const auto bar = [&](double distance) { return rise(std::abs(distance), 0.014, 0.014 + 2 * edge); };
    const double panes = opening * bar(x) * bar(y - top) * bar(y - (top + bottom) / 2);
    const Rgb room = (0.03 + 0.01 * d.z) * Rgb{1, 0.95, 0.88};
    return room + 9 * panes * (0.75 + 0.25 * rise(y, bottom, top)) * glass[(int(place) + 6) % 6];
}

struct Row {
    const char *name, *sentence;
    Rgb (*radiance)(Vec3);
    double brightest;  ///< luminance of the brightest matte white surface in it
    int height;
};
constexpr Row rows[] = {
    {"white", "The same light from everywhere, radiance 1.", white, 1, 4},
    {"sky", "A blue sky with a warm horizon, a soft sun and dull ground.", sky, 1.605, 512},
    {"studio", "Two soft boxes in the dark: a large warm one, a narrow cool one.", studio, 1.916, 512},
    {"windows", "Six coloured windows around a dark room.", windows, 1.151, 512},
    {"three-point", "A photographer's key, fill and rim light, for subjects on black, grey and white.", three_point,
     2.017, 512}};

/// At the pixels' centres, scaled so that the brightest surface is as bright as under the white one.
Probe sampled(const Row& row) {
    ProbeImage image{2 * row.height, row.height, {}};
    image.rgb.resize(std::size_t(3) * image.width * image.height);
    parallel_for(image.height, 8, [&](std::int64_t first, std::int64_t last) {
        for (auto y = first; y < last; ++y)
            for (int x = 0; x < image.width; ++x) {
                const Rgb radiance = row.radiance(image.direction(x + 0.5, double(y) + 0.5));
                float* to = image.rgb.data() + 3 * (std::size_t(y) * image.width + x);
                for (int c = 0; c < 3; ++c) to[c] = float(radiance[c] / row.brightest);
            }
    });
    return Probe(image.width, image.height, std::move(image.rgb));
}

}  // namespace

std::vector<ProbeInfo> list_probes() {
    std::vector<ProbeInfo> infos;
    for (const Row& row : rows) infos.push_back({row.name, row.sentence});
    return infos;
}

bool is_probe_name(const std::string& source) { return source.find_first_of("/.") == source.npos; }

Probe builtin_probe(const std::string& name) {
    std::vector<std::string> names;
    for (const Row& row : rows) {
        if (name == row.name) return sampled(row);
        names.push_back(row.name);
    }
    names.push_back(lights_probe);
    throw Error(ErrorCode::usage, fmt::format("no light probe '{}': it is a file (.hdr, .exr) or one of {}{}", name,
                                              fmt::join(names, ", "), did_you_mean(name, names)));
}

}  // namespace chiaro

// What the peers read of a scene file (../scenes) and of their command line.
#pragma once
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace baseline {

using Json = nlohmann::json;
using Options = std::map<std::string, std::string>;

[[noreturn]] inline void fail(const std::string& sentence) {
    std::fprintf(stderr, "%s\n", sentence.c_str());
    std::exit(2);
}

/// --name value pairs over the defaults.
inline Options read_options(int argc, char** argv, Options options) {
    for (int i = 1; i < argc; i += 2) {
        const std::string name = argv[i];
        if (!name.starts_with("--") || i + 1 >= argc) fail("not an option with a value: " + name);
        options[name.substr(2)] = argv[i + 1];
    }
    for (const char* needed : {"scene", "volume", "out"})
        if (options[needed].empty()) fail(std::string("--") + needed + " is missing");
    return options;
}

inline Json read_json(const std::string& path) {
    std::ifstream stream(path);
    if (!stream) fail("cannot read " + path);
    return Json::parse(stream);
}

struct Size {
    int width = 0, height = 0;
};

inline Size read_size(const std::string& text) {
    Size size;
    if (std::sscanf(text.c_str(), "%dx%d", &size.width, &size.height) != 2) fail("not a size: " + text);
    return size;
}

/// The eye of the scene's orbit, turned by `turn_deg`, about a box at the origin.
inline std::array<double, 3> orbit_eye(const Json& camera, const std::array<double, 3>& extent, double turn_deg) {
    constexpr double degree = M_PI / 180;
    const double radius = 0.5 * std::hypot(extent[0], extent[1], extent[2]);
    const double half_angle = camera["view_angle_deg"].get<double>() * degree / 2;
    const double distance = camera["fit_scale"].get<double>() * radius / std::sin(half_angle);
    const double azimuth = (camera["azimuth_deg"].get<double>() + turn_deg) * degree,
                 elevation = camera["elevation_deg"].get<double>() * degree;
    return {extent[0] / 2 + distance * std::cos(elevation) * std::cos(azimuth),
            extent[1] / 2 + distance * std::cos(elevation) * std::sin(azimuth),
            extent[2] / 2 + distance * std::sin(elevation)};
}

}  // namespace baseline

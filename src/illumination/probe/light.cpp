#include "illumination/probe/light.h"

#include "illumination/probe/data.h"
#include "illumination/sh/window.h"

namespace chiaro {
namespace {

/// Band 1 as a vector: Y_1 = √(3/4π) (y, z, x).
Vec3 first_moment(const ShCoefficients& c) { return {c[3], c[1], c[2]}; }

/// From luminance, in the axes of the grid.
void find_direction(const Axes& world_from_grid, Vec3 orbit_up, ShLight& light) {
    ShCoefficients luminance{};
    for (int i = 0; i < max_coefficients; ++i)
        for (int c = 0; c < 3; ++c) luminance[i] += luminance_weights[c] * light.coefficients[c][i];
    const Vec3 moment = first_moment(luminance);
    const double strength = length(moment);
    if (!(strength > 1e-9 * luminance[0])) {
        light.dominant = normalized(orbit_up);
        return;
    }
    light.dominant = turned(world_from_grid, (1 / strength) * moment);
    light.directionality = std::fmin(strength / (std::sqrt(3.0) * luminance[0]), 1);
}

}  // namespace

Probe lighting_probe(const Lighting& lighting) {
    static const Probe white = builtin_probe("white");
    return lighting.loaded_probe ? lighting.loaded_probe : white;
}

double exposure_stops(const Lighting& lighting) {
    if (lighting.probe.exposure.stops) return *lighting.probe.exposure.stops;
    const bool is_file = !lighting.probe.source.empty() && !is_probe_name(lighting.probe.source);
    return is_file && lighting.loaded_probe ? lighting.loaded_probe.data().suitable_stops() : 0;
}

double probe_gain(const Lighting& lighting) { return std::exp2(exposure_stops(lighting)); }

Axes world_from_probe(double rotation_deg, Vec3 orbit_up) {
    const double turn = radians(rotation_deg);
    return {orbit_direction(turn, 0, orbit_up), orbit_direction(turn + std::numbers::pi / 2, 0, orbit_up),
            normalized(orbit_up)};
}

Axes grid_from_world(const Geometry& geometry) { return transposed(nearest_orthogonal(geometry.direction)); }

Axes grid_from_probe(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry) {
    return composed(grid_from_world(geometry), world_from_probe(lighting.probe.rotation_deg, orbit_up));
}

ShLight sh_light(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry, ShWindow window, int bands) {
    const Axes grid = grid_from_world(geometry);
    const ShRotation rotation(grid_from_probe(lighting, orbit_up, geometry));
    const double gain = probe_gain(lighting);
    const Probe probe = lighting_probe(lighting);
    ShLight light;
    for (int c = 0; c < 3; ++c) {
        light.coefficients[c] = rotation(probe.data().sh[c]);
        for (double& coefficient : light.coefficients[c]) coefficient *= gain;
        light.mean[c] = light.coefficients[c][0] / std::sqrt(4 * std::numbers::pi);
    }
    find_direction(transposed(grid), orbit_up, light);

    const auto factors = window_factors(window, bands);
    for (ShCoefficients& coefficients : light.coefficients)
        for (int l = 0; l < max_bands; ++l)
            for (int i = l * l; i < (l + 1) * (l + 1); ++i) coefficients[i] *= factors[l];
    return light;
}

}  // namespace chiaro

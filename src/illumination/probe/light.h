// A probe's light as the volume sees it: turned, exposed, in the axes of the voxel grid.
#pragma once
#include <chiaro/lighting.h>

#include "illumination/sh/rotation.h"

namespace chiaro {

/// The probe that lights: the loaded one, else a white one.
Probe lighting_probe(const Lighting& lighting);

/// 2^exposure_stops.
double probe_gain(const Lighting& lighting);

/// World directions of the probe's own axes: what it shows at azimuth a stands at orbit_direction(a + rotation, ·, up).
Axes world_from_probe(double rotation_deg, Vec3 orbit_up);

/// Directions in the axes of the voxel grid from world ones, ω_world = Σ_a ω_a direction[a]; of an oblique grid the
/// nearest orthogonal axes. A left-handed grid is a reflection.
Axes grid_from_world(const Geometry& geometry);

/// Directions in the axes of the voxel grid from those of the probe, turned as `lighting` says.
Axes grid_from_probe(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry);

struct ShLight {
    std::array<ShCoefficients, 3> coefficients{};  ///< L_lm per channel, in the axes of the voxel grid
    Rgb mean{};                                    ///< radiance, over the whole sphere
    Vec3 dominant{0, 0, 1};                        ///< unit, world: towards most of the light; up where that is nowhere
    double directionality = 0;  ///< |L_1| / (√3 L_00) of the luminance: 0 from everywhere alike, 1 from one direction
};

/// Without a cosine lobe; bands from `bands` on are 0. Cost: some 20 µs, nothing that depends on the probe's size.
ShLight sh_light(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry, ShWindow window,
                 int bands = max_bands);

}  // namespace chiaro

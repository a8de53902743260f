// The probe's light as directions bring it to the grid.
#pragma once
#include <chiaro/lighting.h>

#include "illumination/probe/dominant.h"

namespace chiaro {

/// Light of one direction's part of the sphere, grid axes.
struct IncidentRay {
    std::array<double, 3> light{};  ///< ∫ L dω / 4π per channel
    double share = 0;               ///< of the sphere
};

struct IncidentLight {
    std::vector<IncidentRay> rays;          ///< one for each of the directions asked for
    std::optional<DominantLight> dominant;  ///< taken out of the rays
};

/// The probe turned and exposed as `lighting` says, in pieces each of which is given to the nearest direction,
/// so that no light is lost. Cost: 8192 × directions products.
IncidentLight incident_light(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry,
                             const std::vector<Vec3>& directions);

}  // namespace chiaro

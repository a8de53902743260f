// The probe's light as directions bring it to the grid.
#pragma once
#include <chiaro/lighting.h>

#include <array>
#include <optional>
#include <vector>

namespace chiaro {

/// Light of one direction's part of the sphere, grid axes.
struct IncidentRay {
    std::array<double, 3> light{};  ///< ∫ L dω / 4π per channel
    double share = 0;               ///< of the sphere
};

/// What stands out as a light of its own, narrow enough to throw sharp shadows.
struct DominantLight {
    Vec3 direction;  ///< unit, grid axes, towards it
    std::array<double, 3> light;
};

struct IncidentLight {
    std::vector<IncidentRay> rays;          ///< one for each of the directions asked for
    std::optional<DominantLight> dominant;  ///< taken out of the rays
};

/// The probe turned and exposed as `lighting` says, gathered in cells of some 3° and each given to the nearest
/// direction, so that no light is lost. A sun is the brightest place where the excess within 8° over what lies around
/// makes up a tenth of all light. Cost: a look at each pixel, 8192 × directions products.
IncidentLight incident_light(const Lighting& lighting, Vec3 orbit_up, const Geometry& geometry,
                             const std::vector<Vec3>& directions);

}  // namespace chiaro

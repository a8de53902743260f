#include <algorithm>
#include <cmath>

#include "look.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkRenderer.h"

namespace chiaro::from_vtk {
namespace {

struct Arrow {
    Vec3 from, to;
};
/// A light's position and focal point in the world.
Arrow arrow_of(vtkLight& light) {
    double from[3], to[3];
    light.GetTransformedPosition(from), light.GetTransformedFocalPoint(to);
    return {{from[0], from[1], from[2]}, {to[0], to[1], to[2]}};
}

/// Of a point of the world.
Vec3 in_volume(const Placement& place, Vec3 p) {
    const auto& m = place.world_from_volume;
    return 1 / (place.scale * place.scale) * turned_back(place, p - Vec3{m[3], m[7], m[11]});
}

Light light_of(vtkLight& from, const Placement& place, std::string& note) {
    Light light;
    const double* rgb = from.GetDiffuseColor();
    for (std::size_t c = 0; c < 3; ++c) light.color[c] = std::max(rgb[c] * from.GetIntensity(), 0.0);
    if (!std::equal(rgb, rgb + 3, from.GetSpecularColor())) note = "highlights have a light's diffuse colour";
    const auto [source, target] = arrow_of(from);
    if (from.GetPositional()) {
        const double* fades = from.GetAttenuationValues();
        if (from.GetConeAngle() < 90) note = "a spotlight shines in all directions";
        if (fades[0] != 1 || fades[1] != 0 || fades[2] != 0) note = "a positional light is as bright at any distance";
        light.position_mm = in_volume(place, source);
    } else if (!from.LightTypeIsHeadlight()) {
        const Vec3 towards = normalized(turned_back(place, source - target));
        light.azimuth_deg = std::atan2(towards.y, towards.x) / radians(1);
        light.elevation_deg = std::asin(std::clamp(towards.z, -1.0, 1.0)) / radians(1);
    }
    light.headlight = !from.GetPositional() && from.LightTypeIsHeadlight();
    return light;
}

}  // namespace

void set_lights(Lighting& lighting, vtkRenderer& renderer, const Placement& place, std::string& note) {
    vtkCollectionSimpleIterator at;
    vtkLightCollection* lights = renderer.GetLights();
    if (lights->GetNumberOfItems() == 0) return;
    lighting.lights.clear();
    lights->InitTraversal(at);
    while (vtkLight* light = lights->GetNextLight(at)) {
        if (!light->GetSwitch() || !(light->GetIntensity() > 0)) continue;
        if (lighting.lights.size() == max_lights)
            note = "more than eight lights: the first eight shine";
        else
            lighting.lights.push_back(light_of(*light, place, note));
    }
}

}  // namespace chiaro::from_vtk

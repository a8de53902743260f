#include "illumination/lit_field.h"

#include <cmath>

#include "illumination/probe/light.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

LitField lit_by_visibility(const IlluminationField::Data& data, const Lighting& lighting, Vec3 orbit_up,
                           const Medium::Data& medium) {
    const bool by_normal = medium.shape.mode == Mode::iso && lighting.shading != Shading::none;
    const auto lit = data.visibility->light({lighting, orbit_up, medium.volume.geometry(), by_normal});
    HostArrays arrays;
    arrays.add(lit, lit->light);
    arrays.add(lit, lit->surface);
    arrays.add(data.visibility, data.visibility->nodes().harmonics);
    return {lit->view, lit->main, lit, {}, arrays};
}

/// Of parallel rays far away.
Vec3 eye_of(const Camera& camera) {
    constexpr double far_mm = 1e7;
    return camera.projection == Projection::perspective ? camera.eye : camera.eye - far_mm * camera.forward;
}

/// The light is there; exposure and strength are factors of it.
LitField lit_by_transport(const IlluminationField::Data& data, const Lighting& lighting, const Camera& camera,
                          const Medium::Data& medium) {
    const Geometry& geometry = medium.volume.geometry();
    const bool shaded = lighting.shading != Shading::none;
    const Look look = data.on_particles ? Look::particles : shaded ? Look::turned : Look::flat;
    const auto shown =
        data.transport->shown(look, transposed(grid_from_world(geometry)), geometry.voxel_from_world(eye_of(camera)));
    const ShLight probe = sh_light(lighting, camera.orbit_up, geometry, ShWindow::none);
    const double strength = lighting.strength, gain = std::exp2(lighting.probe.exposure_stops);
    kernel::VisibilityView view{};
    view.light = shown->view;
    view.scattered = {.on = true,
                      .turned = shown->turned_view,
                      .boundary_cells = shown->boundary_view,
                      .shown = float(strength * gain),
                      .clear = float3((1 - strength) * Vec3{probe.mean[0], probe.mean[1], probe.mean[2]}),
                      .share = float(probe.directionality)};
    HostArrays arrays;
    arrays.add(shown, shown->light);
    arrays.add(shown, shown->turned);
    arrays.add(shown, shown->boundary_cells);
    return {view, MainLight{probe.dominant, 1}, shown, data.albedo_limit, arrays};
}

}  // namespace

LitField lit_field(const IlluminationField& field, const Lighting& lighting, const Camera& camera,
                   const Medium::Data& medium) {
    const Vec3 orbit_up = camera.orbit_up;
    const IlluminationField::Data& data = field.data();
    if (data.visibility) return lit_by_visibility(data, lighting, orbit_up, medium);
    if (data.transport) return lit_by_transport(data, lighting, camera, medium);
    LitField lit{data.view, {}, {}, {}, {}};
    if (data.access) lit.arrays.add(data.access->buffer.array());
    if (data.histogram) data.histogram->add_to(lit.arrays, data.histogram);
    std::visit(
        [&](auto& view) {
            if constexpr (requires { view.strength = 0.5f; }) view.strength = float(lighting.strength);
        },
        lit.view);
    return lit;
}

}  // namespace chiaro

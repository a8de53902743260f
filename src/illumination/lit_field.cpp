#include "illumination/lit_field.h"

#include <cmath>
#include <numbers>

#include "classify/clip.h"
#include "illumination/probe/data.h"
#include "illumination/probe/lambert.h"
#include "illumination/probe/light.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

constexpr double pi = std::numbers::pi;

/// E of each cut, of the light that a probe sends on a surface that faces its way.
kernel::CutLight light_on_cuts(const Lighting& lighting, Vec3 orbit_up, const Medium::Data& medium) {
    const Geometry& geometry = medium.volume.geometry();
    const Probe probe = lighting_probe(lighting);
    const LambertTable& of_normals = probe.data().lambert();
    const Axes probe_from_world = transposed(world_from_probe(lighting.probe.rotation_deg, orbit_up));
    const Vec3 x = geometry.voxel_from_world_vector({1, 0, 0}), y = geometry.voxel_from_world_vector({0, 1, 0}),
               z = geometry.voxel_from_world_vector({0, 0, 1});
    const double all = std::sqrt(4 * pi) / pi * probe_gain(lighting);  // V_00 where nothing lies
    kernel::CutLight light{};
    const auto set = [&](int cut, Vec3 per_voxel) {
        const Vec3 normal{dot(x, per_voxel), dot(y, per_voxel), dot(z, per_voxel)};
        const LambertTable::Entry entry = of_normals.at(turned(probe_from_world, normalized(normal)));
        for (int c = 0; c < 3; ++c) light.rgb[3 * cut + c] = float(all * entry[c][0]);
    };
    int plane = 0;
    for (const HalfSpace& kept : half_spaces(medium.shape.clip, geometry, medium.volume.data().dimensions))
        set(plane++, kept.normal);
    for (int border = 0; border < 6; ++border) {
        Vec3 outward{0, 0, 0};
        outward[border / 2] = border % 2 ? 1 : -1;
        set(kernel::clip_planes + border, outward);
    }
    return light;
}

LitField lit_by_visibility(const IlluminationField::Data& data, const Lighting& lighting, Vec3 orbit_up,
                           const Medium::Data& medium) {
    const auto lit = data.visibility->light({lighting, orbit_up, medium.volume.geometry(), data.surfaces});
    HostArrays arrays;
    arrays.add(lit, lit->light);
    arrays.add(lit, lit->surface);
    arrays.add(data.visibility, data.visibility->nodes().harmonics);
    kernel::VisibilityView view = lit->view;
    if (data.surfaces) view.cut_light = light_on_cuts(lighting, orbit_up, medium);
    return {view, lit->main, lit, {}, data.surfaces, arrays};
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
    const Look look = !data.surfaces ? Look::particles : shaded ? Look::turned : Look::flat;
    const auto shown =
        data.transport->shown(look, transposed(grid_from_world(geometry)), geometry.voxel_from_world(eye_of(camera)));
    const ShLight probe = sh_light(lighting, camera.orbit_up, geometry, ShWindow::none);
    const double strength = lighting.strength, gain = probe_gain(lighting);
    kernel::VisibilityView view{};
    view.light = shown->view;
    view.scattered = {.on = true,
                      .turned = shown->turned_view,
                      .boundary_cells = shown->boundary_view,
                      .shown = float(strength * gain),
                      .clear = float3((1 - strength) * Vec3{probe.mean[0], probe.mean[1], probe.mean[2]}),
                      .share = float(probe.directionality)};
    if (data.surfaces) {
        view.cut_light = light_on_cuts(lighting, camera.orbit_up, medium);
        const float clear[3] = {view.scattered.clear.x, view.scattered.clear.y, view.scattered.clear.z};
        for (int i = 0; i < 3 * kernel::cuts; ++i)
            view.cut_light.rgb[i] = float(strength * view.cut_light.rgb[i]) + clear[i % 3];
    }
    HostArrays arrays;
    arrays.add(shown, shown->light);
    arrays.add(shown, shown->turned);
    arrays.add(shown, shown->boundary_cells);
    return {view, MainLight{probe.dominant, 1}, shown, data.albedo_limit, data.surfaces, arrays};
}

}  // namespace

LitField lit_field(const IlluminationField& field, const Lighting& lighting, const Camera& camera,
                   const Medium::Data& medium) {
    const Vec3 orbit_up = camera.orbit_up;
    const IlluminationField::Data& data = field.data();
    if (data.visibility) return lit_by_visibility(data, lighting, orbit_up, medium);
    if (data.transport) return lit_by_transport(data, lighting, camera, medium);
    LitField lit{data.view, {}, {}, {}, data.surfaces, {}};
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

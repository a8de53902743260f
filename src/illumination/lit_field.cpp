#include "illumination/lit_field.h"

#include <cmath>
#include <numbers>

#include "classify/clip.h"
#include "illumination/floor/floor.h"
#include "illumination/probe/data.h"
#include "illumination/probe/highlight.h"
#include "illumination/probe/lambert.h"
#include "illumination/probe/light.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

constexpr double pi = std::numbers::pi;

/// Node edges off a surface where scattered light is read. Nearer to it neighbours' light is there, but also the
/// surface's own grid: as shown under white (ball, tubes, menger, brain, engine, bonsai) 1.5 leaves the brain 2.7 % too
/// dark and the bonsai 2.2 %, 1.2 leaves 1.7 and 1.4 %; with 1 a ball has rings of .5 % RMS, with 1.2 of .3.
constexpr double scattered_lift = 1.2;
/// ... and voxel edges at least, out of a soft skin (a ball of edge .8 in 64³: its own light adds 3 % with 1.2).
constexpr double least_lift = 2;
/// The same where much is hidden, as in furrows, whose light would be that of their mouth. As shown under white and sky
/// with .6, .9 and none of that: tubes -2.2, -3.0, -3.6 and -2.7, -3.4, -3.9 % of all light, bonsai +3.6, +2.7, +2.0.
constexpr double hidden_lift = 0.9, least_hidden_lift = 0.6;

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

/// Of parallel rays far away.
Vec3 eye_of(const Camera& camera) {
    constexpr double far_mm = 1e7;
    return camera.projection == Projection::perspective ? camera.eye : camera.eye - far_mm * camera.forward;
}

/// What both keep.
std::shared_ptr<const void> keep_both(std::shared_ptr<const void> one, std::shared_ptr<const void> other) {
    return std::make_shared<const std::array<std::shared_ptr<const void>, 2>>(
        std::array{std::move(one), std::move(other)});
}

/// Of a lit view of surfaces; its main light shines no more.
void add_highlight(LitField& lit, const Lighting& lighting, const Camera& camera, const Geometry& geometry) {
    lit.main->share = 0;
    const auto highlight = highlight_of(lighting, camera.orbit_up, -camera.forward);
    if (!highlight) return;
    std::get<kernel::VisibilityView>(lit.view).highlight =
        view_of(*highlight, lighting, camera.orbit_up, eye_of(camera), geometry);
    lit.arrays.add(highlight, highlight->radiance);
    lit.arrays.add(highlight, highlight->reflection.reflected());
    lit.keeps = keep_both(lit.keeps, highlight);
}

LitField lit_by_visibility(const std::shared_ptr<const LitNodes>& nodes, bool surfaces, const Lighting& lighting,
                           const Camera& camera, const Medium::Data& medium, bool particles = true) {
    const Vec3 orbit_up = camera.orbit_up;
    const auto lit = nodes->light({lighting, orbit_up, medium.volume.geometry(), surfaces, particles});
    HostArrays arrays;
    arrays.add(lit, lit->light);
    arrays.add(lit, lit->surface);
    for (const auto& sunlit : lit->sunlit) arrays.add(lit, sunlit);
    arrays.add(nodes, nodes->nodes().harmonics);
    kernel::VisibilityView view = lit->view;
    if (view.crowded.depth) arrays.add(nodes->nodes().density->buffer.array());
    if (surfaces) view.cut_light = light_on_cuts(lighting, orbit_up, medium);
    LitField field{view, lit->main, lit, {}, surfaces, arrays};
    if (surfaces) add_highlight(field, lighting, camera, medium.volume.geometry());
    return field;
}

/// Light that matter has scattered, on particles; exposure and strength are factors of it.
kernel::ScatteredLight scattered_light(const ShownLight& shown, const Lighting& lighting, const ShLight& probe) {
    const double strength = lighting.strength;
    kernel::ScatteredLight scattered{.on = true};
    scattered.boundary_cells = shown.boundary_view;
    scattered.shown = float(strength * probe_gain(lighting));
    scattered.clear = float3((1 - strength) * Vec3{probe.mean[0], probe.mean[1], probe.mean[2]});
    return scattered;
}

/// All light of particles is there.
LitField particles_by_transport(const IlluminationField::Data& data, const Lighting& lighting, const Camera& camera,
                                const Medium::Data& medium) {
    const Geometry& geometry = medium.volume.geometry();
    const auto shown = data.transport->shown(Look::particles, geometry.voxel_from_world(eye_of(camera)));
    const ShLight probe = sh_light(lighting, camera.orbit_up, geometry, ShWindow::none);
    kernel::VisibilityView view{};
    view.light = shown->view;
    view.scattered = scattered_light(*shown, lighting, probe);
    HostArrays arrays;
    arrays.add(shown, shown->light);
    arrays.add(shown, shown->boundary_cells);
    return {view, MainLight{probe.dominant, 1}, shown, data.albedo_limit, false, arrays};
}

/// On surfaces what was not scattered yet comes as visibility has it; on particles all light by transport.
LitField surfaces_by_transport(const IlluminationField::Data& data, const Lighting& lighting, const Camera& camera,
                               const Medium::Data& medium) {
    const TransportNodes& nodes = data.transport->nodes();
    LitField lit = lit_by_visibility(nodes.seen, true, lighting, camera, medium, false);
    const Geometry& geometry = medium.volume.geometry();
    const auto shown = data.transport->shown(Look::surfaces);
    kernel::VisibilityView& view = std::get<kernel::VisibilityView>(lit.view);
    view.light = shown->view;
    view.scattered = scattered_light(*shown, lighting, sh_light(lighting, camera.orbit_up, geometry, ShWindow::none));
    view.scattered.around = shown->around.data();
    const double node_edges = nodes.grid.edge_mm / geometry.smallest_spacing_mm();
    view.scattered.lift_edges = float(std::max(scattered_lift * node_edges, least_lift));
    view.scattered.hidden_lift_edges = float(std::max(hidden_lift * node_edges, least_hidden_lift));
    lit.arrays.add(shown, shown->light);
    lit.arrays.add(shown, shown->around);
    lit.keeps = keep_both(lit.keeps, shown);
    lit.albedo_limit = data.albedo_limit;
    return lit;
}

}  // namespace

LitField lit_field(const IlluminationField& field, const Lighting& shown, const Camera& camera,
                   const Medium::Data& medium) {
    const Lighting lighting = above_floor(shown);
    const IlluminationField::Data& data = field.data();
    if (data.visibility) return lit_by_visibility(data.visibility, data.surfaces, lighting, camera, medium);
    if (data.transport)
        return data.surfaces ? surfaces_by_transport(data, lighting, camera, medium)
                             : particles_by_transport(data, lighting, camera, medium);
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

void read_from(LitField& lit, const LevelPages& pages) {
    const kernel::Float3 scale = float3(Vec3{pages.per_voxel[0], pages.per_voxel[1], pages.per_voxel[2]}),
                         shift = float3(Vec3{pages.shift[0], pages.shift[1], pages.shift[2]});
    const auto move = [&](kernel::GridView& grid) {
        kernel::Float3& per_voxel = grid.nodes_per_voxel;
        grid.shift = {grid.shift.x + per_voxel.x * shift.x, grid.shift.y + per_voxel.y * shift.y,
                      grid.shift.z + per_voxel.z * shift.z};
        per_voxel = {per_voxel.x * scale.x, per_voxel.y * scale.y, per_voxel.z * scale.z};
    };
    if (auto* access = std::get_if<kernel::AccessView>(&lit.view)) {
        move(access->grid);
        access->off_surface.to_level(scale);
    }
    if (auto* visibility = std::get_if<kernel::VisibilityView>(&lit.view)) {
        move(visibility->light.grid), move(visibility->grid);
        visibility->off_surface.to_level(scale);
        kernel::HighlightView& highlight = visibility->highlight;
        const auto to_level = [&](kernel::Float3& row) { row = {row.x * scale.x, row.y * scale.y, row.z * scale.z}; };
        to_level(highlight.world_x), to_level(highlight.world_y), to_level(highlight.world_z);
        kernel::Float3& eye = highlight.eye;
        eye = {(eye.x - shift.x) / scale.x, (eye.y - shift.y) / scale.y, (eye.z - shift.z) / scale.z};
    }
}

}  // namespace chiaro

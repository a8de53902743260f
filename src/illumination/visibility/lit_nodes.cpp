#include "illumination/visibility/lit_nodes.h"

#include <numbers>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/visibility/gpu.h"
#include "illumination/visibility/launch.h"
#include "illumination/visibility/sweep.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

constexpr double pi = std::numbers::pi;

/// Per coefficient as it is kept.
kernel::HarmonicsLight light_on_particles(const VisibilityNodes& nodes, const ShLight& light) {
    kernel::HarmonicsLight particles{};
    for (int c = 0; c < max_coefficients; ++c)
        for (int k = 0; k < 3; ++k)
            particles.coefficients[c][k] = float(light.coefficients[k][c] / (4 * pi) * nodes.step(c));
    return particles;
}

/// Every second normal of the table (a look-up between those is within .1 %), per coefficient as it is kept.
std::vector<kernel::NormalLight> light_on_surfaces(const VisibilityNodes& nodes, const LambertTable& table) {
    constexpr double white[max_bands] = {pi, 2 * pi / 3, pi / 4, 0};  // of max(0, n·ω)
    const auto band = [](int c) { return c == 0 ? 0 : c < 4 ? 1 : c < 9 ? 2 : 3; };
    const int edge = (table.edge + 1) / 2;
    std::vector<kernel::NormalLight> entries(std::size_t(edge) * std::size_t(edge));
    for (int j = 0; j < edge; ++j)
        for (int i = 0; i < edge; ++i) {
            const LambertTable::Entry& light = table.entries[std::size_t(2 * (j * table.edge + i))];
            kernel::NormalLight& entry = entries[std::size_t(j * edge + i)];
            const ShCoefficients y = spherical_harmonics(table.normal(2 * i, 2 * j));
            for (int k = 0; k < 4; ++k)
                for (int c = 0; c < max_coefficients; ++c) {
                    const double bracket = (k < 3 ? double(light[k][c]) : white[band(c)] * y[c]) / pi;
                    entry.bracket[k][c] = float(bracket * nodes.step(c));
                    entry.zonal[band(c)][k] += float(2 * pi * bracket * y[c]);
                }
        }
    return entries;
}

}  // namespace

std::shared_ptr<const LitLight> LitNodes::light(const ProbeLight& probe) const {
    const Lighting& l = probe.lighting;
    const Axes rows = transposed(grid_from_world(probe.geometry));
    const Inputs inputs{l.loaded_probe, l.probe.rotation_deg, exposure_stops(l), l.strength, probe.orbit_up,
                        rows,           probe.surfaces,       probe.particles};
    const std::lock_guard lock(mutex_);
    if (of_ != inputs) {
        kept_ = find(probe);
        of_ = inputs;
    }
    return kept_;
}

void LitNodes::light_all(const kernel::LightKernel& light) const {
    const auto on_gpu = [&] {
        HostArrays arrays;
        arrays.add(weak_from_this(), nodes_.harmonics);
        light_on_gpu(device_, light, arrays, nodes_.grid.size());
    };
    if (cuda::try_gpu(device_, on_gpu)) return;
    const auto light_nodes = kernel::visibility_functions_for(device_.isa).light;
    parallel_for(device_.threads, std::int64_t(nodes_.grid.size()), 4096,
                 [&](std::int64_t first, std::int64_t end) { light_nodes(light, first, std::int32_t(end - first)); });
}

std::vector<std::uint8_t> LitNodes::sunlit(const Lamp& lamp, double node_edges) const {
    static_assert(lamp_parts == 4);  // as many numbers a node as a sweep has at least
    SweptDirections rays({}, {});
    for (std::size_t part = 0; part < lamp.size(); ++part) {
        rays.towards.insert(rays.towards.end(), lamp[part].rays.begin(), lamp[part].rays.end());
        rays.part.resize(rays.towards.size(), int(part));
    }
    Progress progress;
    const ShField field = sweep_visibility(device_, *nodes_.density, rays, lamp_parts, 0.5 / node_edges,
                                           lamp.size() == 1 ? SweepLattice::sheared : SweepLattice::grid, progress);
    const std::size_t parts = lamp.size();
    std::vector<std::uint8_t> share(nodes_.grid.size() * parts);
    parallel_for(device_.threads, std::int64_t(nodes_.grid.size()), 4096, [&](std::int64_t first, std::int64_t end) {
        for (auto node = std::size_t(first); node < std::size_t(end); ++node)
            for (std::size_t part = 0; part < parts; ++part)
                share[node * parts + part] =
                    std::uint8_t(std::clamp(255 * field.node(node)[part], 0.0f, 255.0f) + 0.5f);
    });
    return share;
}

/// As the ray caster reads it.
kernel::SunLight view_of(const Lamp& lamp, const std::vector<std::uint8_t>& sunlit) {
    static_assert(kernel::SunLight::max_parts == lamp_parts && kernel::VisibilityView::max_suns == max_lamps);
    kernel::SunLight view{sunlit.data(), std::int32_t(lamp.size())};
    Vec3 middle;
    for (std::size_t i = 0; i < lamp.size(); ++i) {
        const DominantLight& light = lamp[i].light;
        for (int c = 0; c < 3; ++c) middle = middle + luminance_weights[c] * light.light[c] * light.direction;
        for (int axis = 0; axis < 3; ++axis) view.direction[axis][i] = float(light.direction[axis]);
        for (int c = 0; c < 3; ++c) view.light[i][c] = float(4 * light.light[c]);
    }
    view.ray = float3(lamp.size() == 1 ? lamp[0].light.direction : normalized(middle));
    return view;
}

void LitNodes::light_particles(const ShLight& from, const LambertTable& table, LitLight& lit) const {
    constexpr std::size_t spare = 8;  // look-ups read two nodes at a time
    lit.light = VoxelBuffer((nodes_.grid.size() * 4 + spare) * sizeof(kernel::Light16));
    kernel::LightKernel light{nodes_.view(),
                              light_on_particles(nodes_, from),
                              {},
                              lit.view.strength,
                              reinterpret_cast<kernel::Light16*>(lit.light.data())};
    // Nothing is brighter than where nothing stops the light.
    const double all = std::sqrt(4 * pi);  // V_00 there
    std::array<double, 3> scale;
    for (int k = 0; k < 3; ++k) {
        double brightest = std::max(from.mean[k], 1e-30);
        for (const LambertTable::Entry& entry : table.entries) brightest = std::max(brightest, all * entry[k][0] / pi);
        scale[k] = brightest / kernel::Light16::most;
        light.per_unit[k] = float(1 / scale[k]);
    }
    light_all(light);
    lit.view.light = {light.light, view_of(nodes_.grid), {float(scale[0]), float(scale[1]), float(scale[2])}};
}

std::shared_ptr<const LitLight> LitNodes::find(const ProbeLight& probe) const {
    const int bands = nodes_.coefficients == 4 ? 2 : 4;
    const ShLight from = sh_light(probe.lighting, probe.orbit_up, probe.geometry, nodes_.window, bands);
    const double node_edges = nodes_.grid.edge_mm / probe.geometry.smallest_spacing_mm();
    LambertTable table;
    std::vector<Lamp> lamps;
    if (probe.surfaces) {
        lamps = lamps_of(probe.lighting, probe.orbit_up, probe.geometry);
        table = lambert_table(probe.lighting, probe.orbit_up, probe.geometry, nodes_.window, bands, lamps);
    }
    auto lit = std::make_shared<LitLight>();
    for (const Lamp& lamp : lamps) lit->sunlit.push_back(sunlit(lamp, node_edges));
    lit->surface = light_on_surfaces(nodes_, table);
    const kernel::SurfaceLight surface{lit->surface.empty() ? nullptr : lit->surface.data(), (table.edge + 1) / 2,
                                       float(nodes_.step(0) / std::sqrt(4 * pi))};
    const double strength = probe.lighting.strength, all = std::sqrt(4 * pi);
    lit->view = {.light = {},
                 .grid = view_of(nodes_.grid),
                 .harmonics = nodes_.view(),
                 .surface = surface,
                 .suns = {},
                 .strength = {float(strength), float((1 - strength) * all / nodes_.step(0))},
                 .off_surface = off_surface_of(probe.geometry),
                 .lift_edges = float(surface_lift * node_edges),
                 .crowded = {nullptr, float(crowded_lift * node_edges)},
                 .scattered = {}};
    if (probe.surfaces && nodes_.density) lit->view.crowded.depth = nodes_.density->address();
    if (probe.particles) light_particles(from, table, *lit);
    for (std::size_t i = 0; i < lamps.size(); ++i) lit->view.suns[i] = view_of(lamps[i], lit->sunlit[i]);
    lit->main = {shining_direction(probe.lighting, probe.orbit_up), from.directionality};
    return lit;
}

}  // namespace chiaro

#include "illumination/visibility/lit_nodes.h"

#include <numbers>

#include "core/threads.h"
#include "illumination/probe/lambert.h"
#include "illumination/probe/light.h"
#include "illumination/visibility/launch.h"

namespace chiaro {
namespace {

constexpr double pi = std::numbers::pi;

/// Per coefficient as it is kept.
kernel::HarmonicsLight light_on_particles(const VisibilityNodes& nodes, const ShLight& light) {
    kernel::HarmonicsLight particles{};
    for (int c = 0; c < most_coefficients; ++c)
        for (int k = 0; k < 3; ++k)
            particles.coefficients[c][k] = float(light.coefficients[k][c] / (4 * pi) * nodes.step(c));
    return particles;
}

std::vector<kernel::HarmonicsLight> light_on_surfaces(const VisibilityNodes& nodes, const LambertTable& table) {
    std::vector<kernel::HarmonicsLight> entries(table.entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i)
        for (int c = 0; c < most_coefficients; ++c)
            for (int k = 0; k < 3; ++k)
                entries[i].coefficients[c][k] = float(table.entries[i][k][c] / pi * nodes.step(c));
    return entries;
}

kernel::Float3 float3(Vec3 v) { return {float(v.x), float(v.y), float(v.z)}; }

}  // namespace

/// All that the light at the nodes depends on.
struct LitNodes::Inputs {
    Probe probe;
    double rotation_deg, exposure_stops, strength;
    Vec3 orbit_up;
    Axes rows;  ///< from the world's axes to the grid's
    bool by_normal;
    ShLight light;
    LambertTable table;

    bool same(const Inputs& o) const {
        return std::tie(probe, rotation_deg, exposure_stops, strength, orbit_up, rows, by_normal) ==
               std::tie(o.probe, o.rotation_deg, o.exposure_stops, o.strength, o.orbit_up, o.rows, o.by_normal);
    }
};

std::shared_ptr<const LitLight> LitNodes::light(const ProbeLight& probe) const {
    const Lighting& l = probe.lighting;
    auto inputs = std::make_shared<Inputs>(Inputs{l.loaded_probe,
                                                  l.probe.rotation_deg,
                                                  l.probe.exposure_stops,
                                                  l.strength,
                                                  probe.orbit_up,
                                                  transposed(grid_from_world(probe.geometry)),
                                                  probe.by_normal,
                                                  {},
                                                  {}});
    const std::lock_guard lock(mutex_);
    if (of_ && inputs->same(*of_)) return kept_;
    const int bands = nodes_.coefficients == 4 ? 2 : 4;
    inputs->light = sh_light(l, probe.orbit_up, probe.geometry, nodes_.window, bands);
    if (probe.by_normal || nodes_.surface())
        inputs->table = lambert_table(l, probe.orbit_up, probe.geometry, nodes_.window, bands);
    kept_ = find(*inputs);
    of_ = inputs;
    return kept_;
}

std::shared_ptr<LitLight> LitNodes::find(const Inputs& inputs) const {
    auto lit = std::make_shared<LitLight>();
    lit->surface = light_on_surfaces(nodes_, inputs.table);
    const kernel::SurfaceLight surface{lit->surface.empty() ? nullptr : lit->surface.data(), inputs.table.edge};
    constexpr std::size_t spare = 8;  // look-ups read two nodes at a time
    lit->light = VoxelBuffer((nodes_.grid.size() * 4 + spare) * sizeof(std::uint16_t));

    // Nothing is brighter than where nothing stops the light.
    const double all = std::sqrt(4 * pi);  // V_00 there
    std::array<double, 3> brightest;
    for (int k = 0; k < 3; ++k) {
        brightest[k] = std::max(inputs.light.mean[k], 1e-30);
        for (const LambertTable::Entry& entry : inputs.table.entries)
            brightest[k] = std::max(brightest[k], all * entry[k][0] / pi);
    }
    kernel::LightKernel light{nodes_.view(),
                              nodes_.surface(),
                              light_on_particles(nodes_, inputs.light),
                              surface,
                              {},
                              {float(inputs.strength), float((1 - inputs.strength) * all / nodes_.step(0))},
                              reinterpret_cast<std::uint16_t*>(lit->light.data())};
    for (int k = 0; k < 3; ++k) light.per_unit[k] = float(65535 / brightest[k]);
    const auto light_nodes = kernel::visibility_functions_for(device_.isa).light;
    parallel_for(device_.threads, std::int64_t(nodes_.grid.size()), 4096,
                 [&](std::int64_t first, std::int64_t end) { light_nodes(light, first, std::int32_t(end - first)); });

    lit->view = {light.light,
                 view_of(nodes_.grid),
                 {float(brightest[0] / 65535), float(brightest[1] / 65535), float(brightest[2] / 65535)},
                 nodes_.view(),
                 inputs.by_normal ? surface : kernel::SurfaceLight{nullptr, 0},
                 light.strength,
                 float3(inputs.rows[0]),
                 float3(inputs.rows[1]),
                 float3(inputs.rows[2])};
    return lit;
}

}  // namespace chiaro

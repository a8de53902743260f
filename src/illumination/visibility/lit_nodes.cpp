#include "illumination/visibility/lit_nodes.h"

#include <numbers>

#include "core/threads.h"
#include "illumination/probe/lambert.h"
#include "illumination/probe/light.h"
#include "illumination/visibility/gpu.h"
#include "illumination/visibility/launch.h"
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

std::vector<kernel::HarmonicsLight> light_on_surfaces(const VisibilityNodes& nodes, const LambertTable& table) {
    std::vector<kernel::HarmonicsLight> entries(table.entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i)
        for (int c = 0; c < max_coefficients; ++c)
            for (int k = 0; k < 3; ++k)
                entries[i].coefficients[c][k] = float(table.entries[i][k][c] / pi * nodes.step(c));
    return entries;
}

}  // namespace

std::shared_ptr<const LitLight> LitNodes::light(const ProbeLight& probe) const {
    const Lighting& l = probe.lighting;
    const Axes rows = transposed(grid_from_world(probe.geometry));
    const Inputs inputs{l.loaded_probe, l.probe.rotation_deg, exposure_stops(l), l.strength, probe.orbit_up,
                        rows,           probe.by_normal};
    const std::lock_guard lock(mutex_);
    if (of_ != inputs) {
        kept_ = find(probe, rows);
        of_ = inputs;
    }
    return kept_;
}

void LitNodes::light_all(const kernel::LightKernel& light, const std::vector<kernel::HarmonicsLight>& surface) const {
    const auto on_gpu = [&] {
        HostArrays arrays;
        arrays.add(weak_from_this(), nodes_.harmonics);
        arrays.add(weak_from_this(), nodes_.surfaces);
        arrays.add(surface);
        light_on_gpu(device_, light, arrays, nodes_.grid.size());
    };
    if (cuda::try_gpu(device_, on_gpu)) return;
    const auto light_nodes = kernel::visibility_functions_for(device_.isa).light;
    parallel_for(device_.threads, std::int64_t(nodes_.grid.size()), 4096,
                 [&](std::int64_t first, std::int64_t end) { light_nodes(light, first, std::int32_t(end - first)); });
}

std::shared_ptr<const LitLight> LitNodes::find(const ProbeLight& probe, const Axes& rows) const {
    const int bands = nodes_.coefficients == 4 ? 2 : 4;
    const ShLight from = sh_light(probe.lighting, probe.orbit_up, probe.geometry, nodes_.window, bands);
    LambertTable table;
    if (probe.by_normal || nodes_.surface())
        table = lambert_table(probe.lighting, probe.orbit_up, probe.geometry, nodes_.window, bands);
    auto lit = std::make_shared<LitLight>();
    lit->surface = light_on_surfaces(nodes_, table);
    const kernel::SurfaceLight surface{lit->surface.empty() ? nullptr : lit->surface.data(), table.edge};
    constexpr std::size_t spare = 8;  // look-ups read two nodes at a time
    lit->light = VoxelBuffer((nodes_.grid.size() * 4 + spare) * sizeof(kernel::Light16));

    // Nothing is brighter than where nothing stops the light.
    const double all = std::sqrt(4 * pi);  // V_00 there
    std::array<double, 3> brightest;
    for (int k = 0; k < 3; ++k) {
        brightest[k] = std::max(from.mean[k], 1e-30);
        for (const LambertTable::Entry& entry : table.entries)
            brightest[k] = std::max(brightest[k], all * entry[k][0] / pi);
    }
    const double strength = probe.lighting.strength;
    kernel::LightKernel light{nodes_.view(),
                              nodes_.surface(),
                              light_on_particles(nodes_, from),
                              surface,
                              {},
                              {float(strength), float((1 - strength) * all / nodes_.step(0))},
                              reinterpret_cast<kernel::Light16*>(lit->light.data())};
    std::array<double, 3> scale;
    for (int k = 0; k < 3; ++k) {
        scale[k] = brightest[k] / kernel::Light16::most;
        light.per_unit[k] = float(1 / scale[k]);
    }
    light_all(light, lit->surface);

    lit->view = {.light = {light.light, view_of(nodes_.grid), {float(scale[0]), float(scale[1]), float(scale[2])}},
                 .harmonics = nodes_.view(),
                 .surface = probe.by_normal ? surface : kernel::SurfaceLight{nullptr, 0},
                 .strength = light.strength,
                 .grid_x = float3(rows[0]),
                 .grid_y = float3(rows[1]),
                 .grid_z = float3(rows[2]),
                 .scattered = {}};
    lit->main = {from.dominant, from.directionality};
    return lit;
}

}  // namespace chiaro

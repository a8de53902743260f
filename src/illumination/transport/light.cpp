#include "illumination/transport/light.h"

#include <algorithm>
#include <cmath>

#include "core/srgb.h"
#include "core/threads.h"
#include "illumination/transport/surface.h"

namespace chiaro {
namespace {

using kernel::Light16, kernel::ScatteredLight;

constexpr float full = 1 << 15;   ///< a weight of 1: halves then go down to 2^-29
constexpr std::size_t spare = 8;  ///< look-ups read two nodes at a time

float dot(const Float3& a, const Float3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// J or E at a node, and b, which turns with the sample's normal (ScatteredLight); times a weight.
struct NodeLook {
    float weight = 0;
    Float3 light{}, b{};

    void add(float share, const NodeLook& other) {
        weight += share;
        for (int i = 0; i < 3; ++i) light[i] += share * other.light[i], b[i] += share * other.b[i];
    }
};

/// E = J + 2 M · n of each channel for the node's normal; b tells of luminance how that turns with the sample's.
NodeLook on_surface(const LightAround& around, const Float3& normal, const Float3& most, Look look) {
    NodeLook seen;
    for (int c = 0; c < 3; ++c)
        seen.light[c] = std::clamp(around.j[c] + 2 * dot(around.moment[c], normal), 0.0f, most[c]);
    const float bright = float(luminance(around.j.data()));
    if (look != Look::turned || !(bright > 0)) return seen;
    for (int axis = 0; axis < 3; ++axis) {
        double moment = 0;
        for (int c = 0; c < 3; ++c) moment += luminance_weights[c] * around.moment[c][axis];
        seen.b[axis] = std::clamp(float(2 * moment) / bright, -ScatteredLight::most, ScatteredLight::most);
    }
    const float lambert = 1 + std::abs(dot(seen.b, normal));
    for (float& channel : seen.light) channel /= lambert;
    return seen;
}

/// What a half space under light from all around sends in a direction is (1 - s H(μ)) of it, s = √(1 - a), H(μ) = (1 +
/// 2 μ) / (1 + 2 μ s) (Hapke 1981): over a, 1 / ((1 + s) (1 + 2 μ s)). s from the mean over all directions, R / a = (1
/// - .139 s) / ((1 + 1.17 s) (1 + s)); s = 0, that of isosurfaces, answers alike everywhere.
float answer_at(float mean, float cosine) {
    const float a = 1.17f * mean, b = 2.17f * mean + 0.139f, c = 1 - mean;
    const float s = a > 0 ? (std::sqrt(b * b + 4 * a * c) - b) / (2 * a) : 1;
    return 1 / ((1 + s) * (1 + 2 * cosine * s));
}

NodeLook look_of(const SurfaceNodes& surfaces, const Float3& most, Look look, const std::optional<Vec3>& eye,
                 std::size_t node, int x, int y, int z) {
    const LightAround here = surfaces.at(node);
    const bool as_particles = look == Look::particles;
    const NodeRoles roles = as_particles ? surfaces.particle_roles(x, y, z) : surfaces.roles(x, y, z);
    NodeLook seen;
    if (roles.particles > 0) seen.add(roles.particles, {1, here.j, {}});
    if (!(roles.air > 0) && !(roles.matter > 0)) return seen;
    const NodeOutwards out = surfaces.outwards(x, y, z);
    // Air that shares its cell with matter is as dark as that: there too the light is that one cell out.
    const float passes = surfaces.shows(node) ? 0 : 1 - surfaces.weight(node), clear = passes * passes;
    LightAround beside;
    beside.add(clear, here);
    beside.add(1 - clear, surfaces.off(out, x, y, z));
    NodeLook surface = on_surface(beside, out.normal, most, look);
    if (as_particles) {
        const Float3 mean = surfaces.answer(x, y, z);
        const float cosine = eye ? surfaces.cosine_to(*eye, out, x, y, z) : -1;
        for (int c = 0; c < 3; ++c) surface.light[c] *= cosine < 0 ? mean[c] : answer_at(mean[c], cosine);
    }
    seen.add(roles.air + roles.matter, surface);
    return seen;
}

VoxelBuffer buffer_for(const CellGrid& grid) { return VoxelBuffer((4 * grid.size() + spare) * sizeof(Light16)); }
Light16* numbers(VoxelBuffer& buffer) { return reinterpret_cast<Light16*>(buffer.data()); }

}  // namespace

TransportLight::TransportLight(const Device& device, TransportNodes nodes, double edges,
                               const std::array<float, 3>& most)
    : device_(device), nodes_(std::move(nodes)), most_(most), opacity_(nodes_.weight.size()) {
    // w = 1 - exp(-κ) of a cell is 1 - exp(-κ / edges) of a voxel's edge: fog in wide cells is no surface.
    const double power = 1 / edges;
    const auto work = [&](std::int64_t first, std::int64_t end) {
        for (auto i = std::size_t(first); i < std::size_t(end); ++i)
            opacity_[i] = float(1 - std::pow(1 - std::min(double(nodes_.weight[i]), 1.0), power));
    };
    parallel_for(device_.threads, std::int64_t(opacity_.size()), 4096, work);
}

std::size_t TransportLight::bytes() const {
    const std::lock_guard lock(mutex_);
    return nodes_.bytes() + opacity_.size() * sizeof(float) +
           (kept_ ? kept_->light.size() + kept_->turned.size() : std::size_t(0));
}

std::shared_ptr<const ShownLight> TransportLight::shown(Look look, const Axes& world_from_grid,
                                                        std::optional<Vec3> eye) const {
    const Asked wanted{look, world_from_grid, look == Look::particles ? eye : std::nullopt};
    const std::lock_guard lock(mutex_);
    if (of_ != wanted) {
        kept_ = find(wanted);
        of_ = wanted;
    }
    return kept_;
}

std::shared_ptr<const ShownLight> TransportLight::find(const Asked& asked) const {
    const Look look = asked.look;
    const CellGrid& grid = nodes_.grid;
    const auto [nx, ny, nz] = grid.count;
    auto shown = std::make_shared<ShownLight>();
    shown->light = buffer_for(grid);
    if (look == Look::turned) shown->turned = buffer_for(grid);
    // A surface is at most so much brighter than the light around it.
    constexpr float lambert = 1 + 2 * ScatteredLight::most;
    Float3 brightest{1e-30f, 1e-30f, 1e-30f};
    for (std::size_t i = 0; i < nodes_.light.size(); ++i)
        brightest[i % 3] = std::max(brightest[i % 3], lambert * nodes_.light[i]);

    const SurfaceNodes surfaces(nodes_, opacity_);
    const auto work = [&, nx = nx, ny = ny](std::int64_t row, std::int64_t) {
        const int y = int(row % ny), z = int(row / ny);
        for (int x = 0; x < nx; ++x) {
            const std::size_t node = grid.index(x, y, z);
            const NodeLook seen = look_of(surfaces, most_, look, asked.eye, node, x, y, z);
            Light16* to = numbers(shown->light) + 4 * node;
            for (int c = 0; c < 3; ++c) to[c] = kernel::to_light(full * (seen.light[c] / brightest[c]));
            to[3] = kernel::to_light(full * seen.weight);
            if (look != Look::turned) continue;
            const Vec3 b = turned(asked.world_from_grid, {seen.b[0], seen.b[1], seen.b[2]});
            to = numbers(shown->turned) + 4 * node;
            for (int axis = 0; axis < 3; ++axis)
                to[axis] = kernel::to_light(0.5f * full * (float(b[axis]) / ScatteredLight::most + seen.weight));
        }
    };
    parallel_for(device_.threads, std::int64_t(ny) * nz, 1, work);
    shown->view = {numbers(shown->light), view_of(grid), {brightest[0], brightest[1], brightest[2]}};
    if (look == Look::turned) shown->turned_view = numbers(shown->turned);
    return shown;
}

}  // namespace chiaro

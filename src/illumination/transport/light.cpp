#include "illumination/transport/light.h"

#include <algorithm>
#include <cmath>

#include "core/srgb.h"
#include "core/threads.h"

namespace chiaro {
namespace {

using kernel::Light16, kernel::ScatteredLight;

constexpr float full = 1 << 15;   ///< a weight of 1: halves then go down to 2^-29
constexpr std::size_t spare = 8;  ///< look-ups read two nodes at a time

float dot(const Float3& a, const Float3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// E at a surface, and b, which turns with the sample's normal (ScatteredLight).
struct NodeLook {
    Float3 light{}, b{};
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
float result_at(float mean, float cosine) {
    const float a = 1.17f * mean, b = 2.17f * mean + 0.139f, c = 1 - mean;
    const float s = a > 0 ? (std::sqrt(b * b + 4 * a * c) - b) / (2 * a) : 1;
    return 1 / ((1 + s) * (1 + 2 * cosine * s));
}

/// |n · v|, v from the node to a place in voxels; -1 where there is no n.
float cosine_to(Vec3 eye, const CellGrid& grid, const Float3& n, int x, int y, int z) {
    const Vec3 voxels = eye - grid.voxel_of(x, y, z);
    double along = 0, square = 0, normal = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double v = voxels[axis] / grid.voxels_per_cell[axis];
        along += v * n[axis], square += v * v, normal += double(n[axis]) * n[axis];
    }
    return normal > 0 && square > 0 ? float(std::min(std::abs(along) / std::sqrt(square), 1.0)) : -1;
}

/// The share of a node that is a surface.
NodeLook look_of(const SurfaceNode& surface, const TransportNodes& nodes, const Float3& most, Look look,
                 const std::optional<Vec3>& eye, int y, int z) {
    LightAround beside;
    beside.add(surface.own, light_of(nodes, nodes.grid.index(surface.x, y, z)));
    beside.add(1 - surface.own, surface.beside.of(nodes));
    NodeLook seen = on_surface(beside, surface.normal, most, look);
    if (look != Look::particles) return seen;
    const float cosine = eye ? cosine_to(*eye, nodes.grid, surface.normal, surface.x, y, z) : -1;
    for (int c = 0; c < 3; ++c) seen.light[c] *= cosine < 0 ? surface.result[c] : result_at(surface.result[c], cosine);
    return seen;
}

/// kernel::to_light of a number from 0 to Light16::most, without a branch: the compiler takes several at once.
inline Light16 rounded(float value) {
    constexpr float least = 6.103515625e-05f;
    const std::int32_t bits = kernel::bits_of(std::min(std::max(value, least), Light16::most));
    const std::int32_t half = (bits + 0xfff + ((bits >> 13) & 1) - (112 << 23)) >> 13;
    return {std::uint16_t(value < least ? 0 : half)};
}

/// A row of nodes: J w, w, and b w of those that have surfaces.
class RowLook {
public:
    explicit RowLook(int count) : light_(4 * std::size_t(count)), b_(std::size_t(count)) {}

    void show_particles(const float* weight, const float* j) {
        std::fill(b_.begin(), b_.end(), Float3{});
        for (std::size_t x = 0; x < b_.size(); ++x) {
            for (std::size_t c = 0; c < 3; ++c) light_[4 * x + c] = weight[x] * j[3 * x + c];
            light_[4 * x + 3] = weight[x];
        }
    }
    void add(const SurfaceNode& surface, const NodeLook& look) {
        float* light = light_.data() + 4 * std::size_t(surface.x);
        for (int c = 0; c < 3; ++c) light[c] += surface.weight * look.light[c];
        light[3] += surface.weight;
        for (int axis = 0; axis < 3; ++axis) b_[std::size_t(surface.x)][axis] = surface.weight * look.b[axis];
    }
    void keep(const float (&scale)[4], Light16* to) const {
        for (std::size_t i = 0; i < light_.size(); i += 4)
            for (std::size_t c = 0; c < 4; ++c) to[i + c] = rounded(full * (light_[i + c] / scale[c]));
    }
    void keep_turned(const Axes& world_from_grid, Light16* to) const {
        for (std::size_t x = 0; x < b_.size(); ++x) {
            const float weight = light_[4 * x + 3];
            if (b_[x] == Float3{}) {
                std::fill_n(to + 4 * x, 3, rounded(0.5f * full * weight));
                continue;
            }
            const Vec3 b = turned(world_from_grid, {b_[x][0], b_[x][1], b_[x][2]});
            for (int axis = 0; axis < 3; ++axis)
                to[4 * x + axis] = rounded(0.5f * full * (float(b[axis]) / ScatteredLight::most + weight));
        }
    }

private:
    std::vector<float> light_;
    std::vector<Float3> b_;
};

VoxelBuffer buffer_for(const CellGrid& grid) { return VoxelBuffer((4 * grid.size() + spare) * sizeof(Light16)); }
Light16* numbers(VoxelBuffer& buffer) { return reinterpret_cast<Light16*>(buffer.data()); }

}  // namespace

TransportLight::TransportLight(const Device& device, TransportNodes nodes, double edges,
                               const std::array<float, 3>& most, const TransportLight* before)
    : device_(device), nodes_(std::move(nodes)), most_(most) {
    const bool is_known = before && before->maps_->edges() == edges && is_same_matter(before->nodes_, nodes_);
    maps_ = is_known ? before->maps_ : std::make_shared<SurfaceMaps>(edges);
}

std::size_t TransportLight::bytes() const {
    const std::lock_guard lock(mutex_);
    return nodes_.bytes() + maps_->bytes() + (kept_ ? kept_->bytes() : std::size_t(0));
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
    if (look == Look::turned) shown->turned = buffer_for(grid);
    // A surface is at most so much brighter than the light around it.
    constexpr float lambert = 1 + 2 * ScatteredLight::most;
    Float3 brightest{1e-30f, 1e-30f, 1e-30f};
    for (std::size_t node = 0; node < grid.size(); ++node)
        for (int c = 0; c < 3; ++c) brightest[c] = std::max(brightest[c], lambert * nodes_.light[3 * node + c]);

    const float scale[4] = {brightest[0], brightest[1], brightest[2], 1};
    const auto keep = [&, nx = nx, ny = ny](Reading reading, VoxelBuffer& to) {
        const auto map = maps_->of(device_, nodes_, reading);
        to = buffer_for(grid);
        parallel_for(device_.threads, std::int64_t(ny) * nz, 8, [&](std::int64_t first, std::int64_t end) {
            RowLook row(nx);
            for (std::int64_t r = first; r < end; ++r) {
                const std::size_t start = std::size_t(r) * nx;
                row.show_particles(map->particles.data() + start, nodes_.light.data() + 3 * start);
                for (const SurfaceNode& surface : map->surfaces[std::size_t(r)])
                    row.add(surface, look_of(surface, nodes_, most_, look, asked.eye, int(r % ny), int(r / ny)));
                row.keep(scale, numbers(to) + 4 * start);
                if (look == Look::turned) row.keep_turned(asked.world_from_grid, numbers(shown->turned) + 4 * start);
            }
        });
    };
    keep(look == Look::particles ? Reading::particles : Reading::surfaces, shown->light);
    if (look == Look::particles && !nodes_.result.empty()) keep(Reading::boundary_cells, shown->boundary_cells);
    shown->view = {numbers(shown->light), view_of(grid), {brightest[0], brightest[1], brightest[2]}};
    if (look == Look::turned) shown->turned_view = numbers(shown->turned);
    if (shown->boundary_cells.size() > 0) shown->boundary_view = numbers(shown->boundary_cells);
    return shown;
}

}  // namespace chiaro

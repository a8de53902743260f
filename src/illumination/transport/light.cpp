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

/// E = J + 2 M · n of each channel for the node's normal.
Float3 on_surface(const LightAround& around, const Float3& normal, const Float3& most) {
    Float3 seen;
    for (int c = 0; c < 3; ++c) seen[c] = std::clamp(around.j[c] + 2 * dot(around.moment[c], normal), 0.0f, most[c]);
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

/// An opaque node, or the air beside one.
Float3 look_of(const SurfaceNode& surface, const TransportNodes& nodes, const Float3& most,
               const std::optional<Vec3>& eye, int y, int z) {
    LightAround beside;
    beside.add(surface.own, light_of(nodes, nodes.grid.index(surface.x, y, z)));
    beside.add(1 - surface.own, surface.beside.of(nodes));
    Float3 seen = on_surface(beside, surface.normal, most);
    const float cosine = eye ? cosine_to(*eye, nodes.grid, surface.normal, surface.x, y, z) : -1;
    for (int c = 0; c < 3; ++c) seen[c] *= cosine < 0 ? surface.result[c] : result_at(surface.result[c], cosine);
    return seen;
}

/// kernel::to_light of a number from 0 to Light16::most, without a branch: the compiler takes several at once.
inline Light16 rounded(float value) {
    constexpr float least = 6.103515625e-05f;
    const std::int32_t bits = kernel::bits_of(std::min(std::max(value, least), Light16::most));
    const std::int32_t half = (bits + 0xfff + ((bits >> 13) & 1) - (112 << 23)) >> 13;
    return {std::uint16_t(value < least ? 0 : half)};
}

/// A row of nodes: J w and w.
class RowLook {
public:
    explicit RowLook(int count) : light_(4 * std::size_t(count)) {}

    void show_particles(const float* weight, const float* j) {
        for (std::size_t x = 0; 4 * x < light_.size(); ++x) {
            for (std::size_t c = 0; c < 3; ++c) light_[4 * x + c] = weight[x] * j[3 * x + c];
            light_[4 * x + 3] = weight[x];
        }
    }
    void add(const SurfaceNode& surface, const Float3& look) {
        float* light = light_.data() + 4 * std::size_t(surface.x);
        for (int c = 0; c < 3; ++c) light[c] += surface.weight * look[c];
        light[3] += surface.weight;
    }
    void keep(const float (&scale)[4], Light16* to) const {
        for (std::size_t i = 0; i < light_.size(); i += 4)
            for (std::size_t c = 0; c < 4; ++c) to[i + c] = rounded(full * (light_[i + c] / scale[c]));
    }

private:
    std::vector<float> light_;
};

/// std::lround of a small number, without a call: the compiler takes several at once.
inline int whole(float value) {
    const int below = int(value);
    const float rest = value - float(below);
    return below + (rest >= 0.5f) - (rest <= -0.5f);
}

/// `scattered` of nodes.h in few bits.
kernel::AroundNode around_node(const float* scattered, float weight) {
    kernel::AroundNode node{{}, 1e-30f, 1.001f - weight};  // what the node lets through, and never 0
    for (int i = 0; i < 12; ++i) node.step = std::max(node.step, node.open * std::abs(scattered[i]) / 127);
    for (int i = 0; i < 12; ++i) node.numbers[i + i / 3] = std::int8_t(whole(node.open * scattered[i] / node.step));
    return node;
}

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

std::shared_ptr<const ShownLight> TransportLight::shown(Look look, std::optional<Vec3> eye) const {
    const Asked wanted{look, look == Look::particles ? eye : std::nullopt};
    const std::lock_guard lock(mutex_);
    if (of_ != wanted) {
        kept_ = std::make_shared<const ShownLight>(look == Look::particles ? particles(eye) : surfaces());
        of_ = wanted;
    }
    return kept_;
}

/// Of all nodes, `factor` × J.
Float3 TransportLight::brightest(float factor) const {
    Float3 brightest{1e-30f, 1e-30f, 1e-30f};
    for (std::size_t node = 0; node < nodes_.grid.size(); ++node)
        for (std::size_t c = 0; c < 3; ++c) brightest[c] = std::max(brightest[c], factor * nodes_.light[3 * node + c]);
    return brightest;
}

ShownLight TransportLight::particles(const std::optional<Vec3>& eye) const {
    const CellGrid& grid = nodes_.grid;
    const auto [nx, ny, nz] = grid.count;
    // What an opaque cell answers to: J + 2 M · n, where M is no longer than J; a little more where light was found by
    // several sweeps.
    const Float3 most = brightest(5);
    const float scale[4] = {most[0], most[1], most[2], 1};
    ShownLight shown;
    const auto keep = [&, nx = nx, ny = ny, nz = nz](Reading reading, VoxelBuffer& to) {
        const auto map = maps_->of(device_, nodes_, reading);
        to = buffer_for(grid);
        parallel_for(device_.threads, std::int64_t(ny) * nz, 8, [&](std::int64_t first, std::int64_t end) {
            RowLook row(nx);
            for (std::int64_t r = first; r < end; ++r) {
                const std::size_t start = std::size_t(r) * std::size_t(nx);
                row.show_particles(map->particles.data() + start, nodes_.light.data() + 3 * start);
                for (const SurfaceNode& surface : map->surfaces[std::size_t(r)])
                    row.add(surface, look_of(surface, nodes_, most_, eye, int(r % ny), int(r / ny)));
                row.keep(scale, numbers(to) + 4 * start);
            }
        });
    };
    keep(Reading::particles, shown.light);
    if (!nodes_.result.empty()) keep(Reading::boundary_cells, shown.boundary_cells);
    shown.view = {numbers(shown.light), view_of(grid), {most[0], most[1], most[2]}};
    if (shown.boundary_cells.size() > 0) shown.boundary_view = numbers(shown.boundary_cells);
    return shown;
}

/// Each node weighs as its matter; what surfaces add is read from the open.
ShownLight TransportLight::surfaces() const {
    const CellGrid& grid = nodes_.grid;
    const Float3 most = brightest(1);
    const float scale[4] = {most[0], most[1], most[2], 1};
    ShownLight shown;
    shown.light = buffer_for(grid);
    shown.around.resize(grid.size());
    parallel_for(device_.threads, std::int64_t(grid.count[1]) * grid.count[2], 8,
                 [&](std::int64_t first, std::int64_t end) {
                     RowLook row(grid.count[0]);
                     for (std::int64_t r = first; r < end; ++r) {
                         const std::size_t start = std::size_t(r) * std::size_t(grid.count[0]);
                         row.show_particles(nodes_.weight.data() + start, nodes_.light.data() + 3 * start);
                         row.keep(scale, numbers(shown.light) + 4 * start);
                         for (std::size_t node = start; node < start + std::size_t(grid.count[0]); ++node)
                             shown.around[node] = around_node(nodes_.scattered.data() + 12 * node, nodes_.weight[node]);
                     }
                 });
    shown.view = {numbers(shown.light), view_of(grid), {most[0], most[1], most[2]}};
    return shown;
}

}  // namespace chiaro

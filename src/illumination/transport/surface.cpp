#include "illumination/transport/surface.h"

#include <algorithm>
#include <cmath>

#include "core/threads.h"

namespace chiaro {
namespace {

float square(const Float3& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// w = 1 - exp(-κ) of a cell is 1 - exp(-κ / edges) of a voxel's edge: fog in wide cells is no surface.
std::vector<float> opacity_of(const Device& device, const TransportNodes& nodes, double edges) {
    std::vector<float> opacity(nodes.weight.size());
    const double power = 1 / edges;
    const auto work = [&](std::int64_t first, std::int64_t end) {
        for (auto i = std::size_t(first); i < std::size_t(end); ++i) {
            const bool as_before = i > std::size_t(first) && nodes.weight[i] == nodes.weight[i - 1];
            opacity[i] =
                as_before ? opacity[i - 1] : float(1 - std::pow(1 - std::min(double(nodes.weight[i]), 1.0), power));
        }
    };
    parallel_for(device.threads, std::int64_t(opacity.size()), 4096, work);
    return opacity;
}

/// Of each number and the two beside it.
void largest_in_row(const float* values, int count, float* to) {
    for (int x = 0; x < count; ++x) {
        const float before = x > 0 ? values[x - 1] : 0, after = x + 1 < count ? values[x + 1] : 0;
        to[x] = std::max(std::max(before, values[x]), after);
    }
}

/// Of each node and its 26 neighbours, axis by axis; 0 outside.
std::vector<float> largest_around(const Device& device, const CellGrid& grid, const std::vector<float>& values) {
    const auto [nx, ny, nz] = grid.count;
    const std::vector<float> outside(std::size_t(nx), 0.0f);
    const auto over = [&, nx = nx](const std::vector<float>& from, const std::array<int, 3>& step) {
        std::vector<float> to(from.size());
        const auto row_at = [&](int y, int z) {
            return grid.holds(0, y, z) ? from.data() + grid.index(0, y, z) : outside.data();
        };
        parallel_for(device.threads, grid.count[2], 1, [&](std::int64_t plane, std::int64_t) {
            const int z = int(plane);
            for (int y = 0; y < grid.count[1]; ++y) {
                const float *before = row_at(y - step[1], z - step[2]), *here = row_at(y, z),
                            *after = row_at(y + step[1], z + step[2]);
                float* row = to.data() + grid.index(0, y, z);
                if (step[0])
                    largest_in_row(here, nx, row);
                else
                    for (int x = 0; x < nx; ++x) row[x] = std::max(std::max(before[x], here[x]), after[x]);
            }
        });
        return to;
    };
    return over(over(over(values, {1, 0, 0}), {0, 1, 0}), {0, 0, 1});
}

}  // namespace

SurfaceNodes::SurfaceNodes(const Device& device, const TransportNodes& nodes, double edges)
    : nodes_(nodes), opacity_(opacity_of(device, nodes, edges)) {
    if (nodes.result.empty()) return;
    std::vector<float> shown(opacity_.size());
    for (std::size_t node = 0; node < shown.size(); ++node) shown[node] = nodes.result[3 * node];
    results_ = largest_around(device, nodes.grid, shown);
}

LightAround light_of(const TransportNodes& nodes, std::size_t node) {
    LightAround light;
    for (int c = 0; c < 3; ++c) {
        light.j[c] = nodes.light[3 * node + c];
        for (int axis = 0; axis < 3; ++axis) light.moment[c][axis] = nodes.moment[9 * node + 3 * c + axis];
    }
    return light;
}

LightAround LightBeside::of(const TransportNodes& light) const {
    LightAround total, mean;
    for (int i = 0; i < 8; ++i)
        if (weights[i] > 0) total.add(weights[i], light_of(light, nodes[i]));
    mean.add(1 / sum, total);
    return mean;
}

float SurfaceNodes::alpha(int x, int y, int z) const {
    return nodes_.grid.holds(x, y, z) ? opacity_[nodes_.grid.index(x, y, z)] : 0;
}

Float3 SurfaceNodes::step_down(int x, int y, int z, int d) const {
    return {alpha(x - d, y, z) - alpha(x + d, y, z), alpha(x, y - d, z) - alpha(x, y + d, z),
            alpha(x, y, z - d) - alpha(x, y, z + d)};
}

NodeOutwards SurfaceNodes::outwards(int x, int y, int z) const {
    Float3 n = step_down(x, y, z, 1);
    float edges = 1;
    if (alpha(x, y, z) >= 0.5f) {
        const Float3 wide = step_down(x, y, z, 2);
        if (square(wide) > square(n)) n = wide, edges = 2;
    }
    const float size = std::sqrt(square(n));
    if (!(size > 0)) return {};
    for (float& component : n) component /= size;
    return {n, edges * std::min(size, 1.0f)};
}

bool SurfaceNodes::is_air(int x, int y, int z) const {
    constexpr float clear = 0.02f;  // stops less than a fiftieth of the light; chosen by eye as far as history shows
    if (!nodes_.grid.holds(x, y, z)) return true;
    const std::size_t node = nodes_.grid.index(x, y, z);
    return nodes_.weight[node] < clear || is_boundary(node);
}

/// Air beside opaque matter counts, and what is opaque hardly: its one light is that of all its sides.
NodeRoles SurfaceNodes::particle_roles(int x, int y, int z) const {
    constexpr float least = 1e-3f;
    const std::size_t node = nodes_.grid.index(x, y, z);
    const float weight = nodes_.weight[node];
    if (nodes_.result.empty()) return {weight, 0, 0};
    const bool shows_surface = shows(node);
    if (weight >= opaque_weight && !shows_surface) return {least * least, 0, 0};
    if (is_air(x, y, z)) return results_[node] > 0 ? NodeRoles{0, 1, 0} : NodeRoles{weight, 0, 0};
    if (!shows_surface) return {weight, 0, 0};
    const bool has_air = is_air(x - 1, y, z) || is_air(x + 1, y, z) || is_air(x, y - 1, z) || is_air(x, y + 1, z) ||
                         is_air(x, y, z - 1) || is_air(x, y, z + 1);
    return has_air ? NodeRoles{0, 0, least} : NodeRoles{weight, 0, 0};
}

NodeRoles SurfaceNodes::boundary_roles(int x, int y, int z) const {
    constexpr float hardly = 1e-6f;  // counts only where nothing else does: a thousandth of what matter weighs
    const std::size_t node = nodes_.grid.index(x, y, z);
    const NodeRoles roles = particle_roles(x, y, z);
    if (nodes_.result.empty() || !(roles.particles > 0)) return roles;
    if (nodes_.weight[node] >= opaque_weight) return {hardly, 0, 0};
    return results_[node] > 0 ? NodeRoles{0, 1, 0} : roles;
}

Float3 SurfaceNodes::result(int x, int y, int z) const {
    const auto [nx, ny, nz] = nodes_.grid.count;
    Float3 sum{};
    float count = 0;
    for (int k = std::max(z - 1, 0); k <= std::min(z + 1, nz - 1); ++k)
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, ny - 1); ++j)
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, nx - 1); ++i) {
                const float* result = nodes_.result.data() + 3 * nodes_.grid.index(i, j, k);
                if (!(result[0] > 0)) continue;
                for (int c = 0; c < 3; ++c) sum[c] += result[c];
                count += 1;
            }
    for (float& channel : sum) channel = count > 0 ? channel / count : 0;
    return sum;
}

LightBeside SurfaceNodes::off(const NodeOutwards& outwards, int x, int y, int z) const {
    const std::array<int, 3> here{x, y, z};
    std::array<int, 3> low, high;
    Float3 t;
    for (int axis = 0; axis < 3; ++axis) {
        const float p = float(here[axis]) + outwards.edges * outwards.normal[axis], whole = std::floor(p);
        t[axis] = p - whole;
        low[axis] = std::clamp(int(whole), 0, nodes_.grid.count[axis] - 1);
        high[axis] = std::clamp(int(whole) + 1, 0, nodes_.grid.count[axis] - 1);
    }
    LightBeside beside;
    for (int corner = 0; corner < 8; ++corner) {
        std::array<int, 3> place;
        float weight = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const bool further = corner >> axis & 1;
            place[axis] = further ? high[axis] : low[axis];
            weight *= further ? t[axis] : 1 - t[axis];
        }
        if (!(weight > 0)) continue;
        const std::size_t node = nodes_.grid.index(place[0], place[1], place[2]);
        weight *= 1.001f - nodes_.weight[node];  // what the node lets through, and never 0
        beside.nodes[corner] = std::uint32_t(node), beside.weights[corner] = weight;
        beside.sum += weight;
    }
    return beside;
}

}  // namespace chiaro

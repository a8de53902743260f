#include "illumination/transport/surface.h"

#include <algorithm>
#include <cmath>

namespace chiaro {
namespace {

float square(const Float3& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

}  // namespace

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

/// The densest and the clearest of the 26 neighbours tell. Light on a surface is that of the air beside it: nodes of
/// the air weigh as what they let through, those of the matter nearly nothing (in a corner they face another room).
NodeRoles SurfaceNodes::roles(int x, int y, int z) const {
    constexpr float least = 1e-3f;
    const float here = alpha(x, y, z);
    float densest = here, clearest = here;
    for (int k = -1; k <= 1; ++k)
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) {
                const float there = alpha(x + i, y + j, z + k);
                densest = std::max(densest, there), clearest = std::min(clearest, there);
            }
    const float weight = nodes_.weight[nodes_.grid.index(x, y, z)];
    const float outside = std::min(4 * (densest - here), 1.0f), inside = std::min(4 * (here - clearest), 1.0f);
    // Behind a surface opaque matter is dark and counts for less still: what is seen of it lies at its skin.
    const float seen = std::max(1 - 2 * here, 0.0f), buried = least * least;
    return {weight * (1 - std::max(outside, inside)) * seen + buried, outside * (1 - weight), least * inside};
}

bool SurfaceNodes::is_air(int x, int y, int z) const {
    constexpr float clear = 0.02f;
    if (!nodes_.grid.holds(x, y, z)) return true;
    const std::size_t node = nodes_.grid.index(x, y, z);
    return nodes_.weight[node] < clear || is_skin(node);
}

/// Air beside opaque matter counts, and what is opaque hardly: its one light is that of all its sides.
NodeRoles SurfaceNodes::particle_roles(int x, int y, int z) const {
    constexpr float least = 1e-3f;
    const std::size_t node = nodes_.grid.index(x, y, z);
    const float weight = nodes_.weight[node];
    if (nodes_.answer.empty()) return {weight, 0, 0};
    const bool shows_surface = shows(node);
    if (weight >= opaque_weight && !shows_surface) return {least * least, 0, 0};
    if (is_air(x, y, z)) {
        const Float3 beside = answer(x, y, z);
        const bool is_lit = beside[0] > 0 || beside[1] > 0 || beside[2] > 0;
        return is_lit ? NodeRoles{0, 1, 0} : NodeRoles{weight, 0, 0};
    }
    if (!shows_surface) return {weight, 0, 0};
    const bool has_air = is_air(x - 1, y, z) || is_air(x + 1, y, z) || is_air(x, y - 1, z) || is_air(x, y + 1, z) ||
                         is_air(x, y, z - 1) || is_air(x, y, z + 1);
    return has_air ? NodeRoles{0, 0, least} : NodeRoles{weight, 0, 0};
}

Float3 SurfaceNodes::answer(int x, int y, int z) const {
    const auto [nx, ny, nz] = nodes_.grid.count;
    Float3 sum{};
    float count = 0;
    for (int k = std::max(z - 1, 0); k <= std::min(z + 1, nz - 1); ++k)
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, ny - 1); ++j)
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, nx - 1); ++i) {
                const float* answer = nodes_.answer.data() + 3 * nodes_.grid.index(i, j, k);
                if (!(answer[0] > 0)) continue;
                for (int c = 0; c < 3; ++c) sum[c] += answer[c];
                count += 1;
            }
    for (float& channel : sum) channel = count > 0 ? channel / count : 0;
    return sum;
}

float SurfaceNodes::cosine_to(Vec3 eye, const NodeOutwards& outwards, int x, int y, int z) const {
    const CellGrid& grid = nodes_.grid;
    const Vec3 voxels = eye - grid.voxel_of(x, y, z);
    double along = 0, square = 0, normal = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double v = voxels[axis] / grid.voxels_per_cell[axis], n = outwards.normal[axis];
        along += v * n, square += v * v, normal += n * n;
    }
    return normal > 0 && square > 0 ? float(std::min(std::abs(along) / std::sqrt(square), 1.0)) : -1;
}

LightAround SurfaceNodes::at(std::size_t node) const {
    LightAround light;
    for (int c = 0; c < 3; ++c) {
        light.j[c] = nodes_.light[3 * node + c];
        for (int axis = 0; axis < 3; ++axis) light.moment[c][axis] = nodes_.moment[9 * node + 3 * c + axis];
    }
    return light;
}

LightAround SurfaceNodes::off(const NodeOutwards& outwards, int x, int y, int z) const {
    const std::array<int, 3> here{x, y, z};
    std::array<int, 3> low, high;
    Float3 t;
    for (int axis = 0; axis < 3; ++axis) {
        const float p = float(here[axis]) + outwards.edges * outwards.normal[axis], whole = std::floor(p);
        t[axis] = p - whole;
        low[axis] = std::clamp(int(whole), 0, nodes_.grid.count[axis] - 1);
        high[axis] = std::clamp(int(whole) + 1, 0, nodes_.grid.count[axis] - 1);
    }
    LightAround sum;
    float weights = 0;
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
        weight *= 1.001f - nodes_.weight[node];
        sum.add(weight, at(node));
        weights += weight;
    }
    LightAround mean;
    mean.add(1 / weights, sum);
    return mean;
}

}  // namespace chiaro

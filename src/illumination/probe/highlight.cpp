#include "illumination/probe/highlight.h"

#include <algorithm>
#include <cmath>

#include "illumination/probe/data.h"
#include "illumination/probe/lambert.h"
#include "illumination/probe/light.h"
#include "volume/float3.h"

namespace chiaro {
namespace {

/// Three coordinates or four channels, node by node: plain loops over them become vectors.
using Nodes = std::vector<float>;

/// weight = cosine^exponent, by squaring.
void raise(Nodes& cosine, Nodes& weight, int exponent) {
    for (; exponent > 0; exponent >>= 1) {
        if (exponent & 1)
            for (std::size_t i = 0; i < weight.size(); ++i) weight[i] *= cosine[i];
        for (std::size_t i = 0; i < cosine.size(); ++i) cosine[i] *= cosine[i];
    }
}

void set_cosines(const std::array<Nodes, 3>& normals, Vec3 direction, Nodes& cosines) {
    const float x = float(direction.x), y = float(direction.y), z = float(direction.z);
    for (std::size_t i = 0; i < cosines.size(); ++i)
        cosines[i] = std::max(0.0f, x * normals[0][i] + y * normals[1][i] + z * normals[2][i]);
}

/// Normals that mirror the eye to the nodes of an unfolded octahedron.
std::array<Nodes, 3> mirroring_normals(int edge, Vec3 to_eye) {
    const std::size_t count = std::size_t(edge) * std::size_t(edge);
    std::array<Nodes, 3> normals{Nodes(count), Nodes(count), Nodes(count)};
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 sum = octahedron_node(int(i) % edge, int(i) / edge, edge) + to_eye;
        const double scale = 1 / std::max(length(sum), 1e-6);  // behind the surface: no light counts
        for (int axis = 0; axis < 3; ++axis) normals[std::size_t(axis)][i] = float(scale * sum[axis]);
    }
    return normals;
}

}  // namespace

Highlight highlight_of_probe(const ProbePieces& pieces, const HighlightKey& key) {
    // Nodes and pieces are 6° apart and wide; 3° for lobes narrower than some 15°.
    constexpr double wide = 80;
    const bool is_wide = key.shininess <= wide;
    Highlight made{key, ReflectionTable(key.strength, key.shininess), is_wide ? 33 : 65, {}};
    const std::array<Nodes, 3> normals = mirroring_normals(made.edge, key.to_eye);
    const std::size_t count = normals[0].size();
    Nodes weight(count), cosine(count);
    std::array<Nodes, 4> sums{Nodes(count), Nodes(count), Nodes(count), Nodes(count)};
    for (const ProbePiece& piece : is_wide ? pieces.coarse : pieces.all) {
        const Vec3 sum = piece.direction + key.to_eye;
        if (!(length(sum) > 1e-6)) continue;
        set_cosines(normals, piece.direction, weight);
        set_cosines(normals, normalized(sum), cosine);
        raise(cosine, weight, int(std::lround(std::min(key.shininess, 1000.0))));
        const std::array<double, 4> light{piece.light[0], piece.light[1], piece.light[2], piece.share};
        for (std::size_t k = 0; k < 4; ++k) {
            const float factor = float(light[k]);
            for (std::size_t i = 0; i < count; ++i) sums[k][i] += factor * weight[i];
        }
    }
    made.radiance.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k) made.radiance[i][k] = sums[k][i] / std::max(sums[3][i], 1e-30f);
    return made;
}

std::shared_ptr<const Highlight> Probe::Data::highlight(const HighlightKey& key) const {
    const std::lock_guard lock(highlight_.mutex);
    if (!highlight_.last || highlight_.last->key != key)
        highlight_.last = std::make_shared<const Highlight>(highlight_of_probe(pieces(), key));
    return highlight_.last;
}

std::shared_ptr<const Highlight> highlight_of(const Lighting& lighting, Vec3 orbit_up, Vec3 to_eye) {
    if (lighting.shading != Shading::phong || !(lighting.specular > 0)) return nullptr;
    const Axes world_from_probe_axes = world_from_probe(lighting.probe.rotation_deg, orbit_up);
    return lighting_probe(lighting).data().highlight(
        {lighting.specular, lighting.shininess, turned(transposed(world_from_probe_axes), to_eye)});
}

kernel::HighlightView view_of(const Highlight& highlight, const Lighting& lighting, Vec3 orbit_up, Vec3 eye_mm,
                              const Geometry& geometry) {
    const Axes axes = world_from_probe(lighting.probe.rotation_deg, orbit_up);
    // Only directions count: in smallest edges, so that tiny or huge spacings stay in float's range.
    const double edge = geometry.smallest_spacing_mm();
    std::array<Vec3, 3> columns;
    for (int axis = 0; axis < 3; ++axis)
        columns[std::size_t(axis)] = (geometry.spacing_mm[axis] / edge) * geometry.direction[std::size_t(axis)];
    const auto row = [&](int k) { return float3({columns[0][k], columns[1][k], columns[2][k]}); };
    kernel::HighlightView view;
    view.radiance = reinterpret_cast<const float(*)[4]>(highlight.radiance.data());
    view.reflected = highlight.reflection.reflected().data();
    view.edge = highlight.edge;
    view.gain = float(probe_gain(lighting));
    view.probe_x = float3(axes[0]), view.probe_y = float3(axes[1]), view.probe_z = float3(axes[2]);
    view.eye = float3(geometry.voxel_from_world(eye_mm));
    view.world_x = row(0), view.world_y = row(1), view.world_z = row(2);
    return view;
}

}  // namespace chiaro

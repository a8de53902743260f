#include "illumination/sh/volume.h"

#include <cstring>

#include "core/threads.h"

namespace chiaro {
namespace {

Volume empty(const std::array<int, 3>& dimensions, int components, const Geometry& geometry) {
    Volume volume = make_volume(dimensions, VoxelType::f32);
    volume.components = components;
    volume.voxels = VoxelBuffer(volume.voxel_count() * std::size_t(components) * sizeof(float));
    volume.geometry = geometry;
    return volume;
}

/// Between which nodes a voxel lies along one axis; beyond the outermost their values go on.
struct Between {
    int node, next;
    float share;
};
Between between(const CellGrid& grid, int axis, int voxel) {
    const double at = std::clamp((voxel + 0.5) / grid.voxels_per_cell[axis] - 0.5, 0.0, grid.count[axis] - 1.0);
    const int node = int(at);
    return {node, std::min(node + 1, grid.count[axis] - 1), float(at - node)};
}

/// Trilinear, coefficient by coefficient.
void interpolate(const ShField& field, const Between& x, const Between& y, const Between& z, float* to) {
    std::fill_n(to, field.coefficients, 0.0f);
    for (int corner = 0; corner < 8; ++corner) {
        const auto [i, wx] = corner & 1 ? std::pair{x.next, x.share} : std::pair{x.node, 1 - x.share};
        const auto [j, wy] = corner & 2 ? std::pair{y.next, y.share} : std::pair{y.node, 1 - y.share};
        const auto [k, wz] = corner & 4 ? std::pair{z.next, z.share} : std::pair{z.node, 1 - z.share};
        const float* from = field.node(field.grid.index(i, j, k));
        for (int c = 0; c < field.coefficients; ++c) to[c] += wx * wy * wz * from[c];
    }
}

bool has_node_per_cell(const CellGrid& nodes, const DeviceVolume& volume) {
    return nodes.count == make_cell_grid(volume.dimensions(), volume.geometry()).count;
}

}  // namespace

Volume volume_of(const Device& device, const ShField& field, const DeviceVolume& volume, Progress& progress) {
    const CellGrid& nodes = field.grid;
    if (nodes.is_voxel_grid || !has_node_per_cell(nodes, volume)) {
        Volume out = empty(nodes.count, field.coefficients, geometry_of(nodes, volume.geometry()));
        std::memcpy(out.voxels.data(), field.buffer.data(), out.voxels.size());
        return out;
    }
    Volume out = empty(volume.dimensions(), field.coefficients, volume.geometry());
    const auto [nx, ny, nz] = out.dimensions;
    const auto fill_row = [&, nx = nx, ny = ny](std::int64_t row, std::int64_t) {
        const Between y = between(nodes, 1, int(row % ny)), z = between(nodes, 2, int(row / ny));
        float* to = out.as<float>().data() + row * nx * field.coefficients;
        for (int x = 0; x < nx; ++x, to += field.coefficients) interpolate(field, between(nodes, 0, x), y, z, to);
    };
    parallel_for(device.threads, std::int64_t(ny) * nz, 1, "voxels", progress, fill_row);
    progress.check();
    return out;
}

}  // namespace chiaro

#include "illumination/cells/rank_nodes.h"

#include <chiaro/error.h>
#include <fmt/format.h>

#include <cstring>

#include "core/ranks.h"
#include "volume/device_volume.h"

namespace chiaro {
namespace {

/// The voxel nearest to a node's centre.
int middle_voxel(const DeviceVolume::Data& volume, const CellGrid& grid, int axis, int node) {
    const double centre = (node + 0.5) * grid.voxels_per_cell[axis] - 0.5;
    return std::clamp(int(std::floor(centre + 0.5)), 0, volume.dimensions[axis] - 1);
}

/// visit(first byte, how many) of each row of a range.
template <class Visit>
void for_rows(const NodeRange& nodes, const CellGrid& grid, std::size_t size, const Visit& visit) {
    for (int z = nodes.first[2]; z < nodes.end[2]; ++z)
        for (int y = nodes.first[1]; y < nodes.end[1]; ++y)
            visit(grid.index(nodes.first[0], y, z) * size, nodes.row() * size);
}

}  // namespace

NodeRange own_nodes(const DeviceVolume::Data& volume, const CellGrid& grid) {
    if (!volume.placement) return {{0, 0, 0}, grid.count};
    const Placement& place = *volume.placement;
    NodeRange own;
    if (!place.owns_any() || volume.held.size[0] < 1) return own;
    for (int axis = 0; axis < 3; ++axis) {
        const auto reaches = [&](int node, int voxel) { return middle_voxel(volume, grid, axis, node) >= voxel; };
        int node = 0;
        while (node < grid.count[axis] && !reaches(node, place.own_first[axis])) ++node;
        own.first[axis] = node;
        while (node < grid.count[axis] && !reaches(node, place.own_end[axis])) ++node;
        own.end[axis] = node;
    }
    return own;
}

void check_ghosts(const DeviceVolume::Data& volume, const CellGrid& grid, int margin) {
    const NodeRange own = own_nodes(volume, grid);
    if (!volume.placement || own.is_empty()) return;
    int missing = 0, there = volume.dimensions[0];
    for (int axis = 0; axis < 3; ++axis) {
        const Placement& place = *volume.placement;
        const auto a = std::size_t(axis);
        const double wide = grid.voxels_per_cell[axis];
        const int first_node = int(std::ceil(own.first[a] * wide - 0.5)),
                  end_node = int(std::floor(own.end[a] * wide - 0.5)) + 1;
        const int first = std::min(first_node - node_margin, place.own_first[a] - margin);
        const int end = std::max(end_node + node_margin, place.own_end[a] + margin);
        const int held = volume.held.first[a], held_end = held + volume.held.size[a];
        if (held > 0) missing = std::max(missing, held - first), there = std::min(there, place.own_first[a] - held);
        if (held_end < volume.dimensions[a])
            missing = std::max(missing, end - held_end), there = std::min(there, held_end - place.own_end[a]);
    }
    if (missing > 0)
        throw Error(ErrorCode::usage,
                    fmt::format("light that ranks share needs {} ghost voxels on each side of a block, and "
                                "there are {}: ask for more ghost levels, or for a finer light grid",
                                there + missing, there));
}

void gather_nodes(const Device& device, const DeviceVolume::Data& volume, const CellGrid& grid, std::byte* values,
                  std::size_t size) {
    const NodeRange own = own_nodes(volume, grid);
    std::vector<std::byte> mine(sizeof own);
    std::memcpy(mine.data(), &own, sizeof own);
    for_rows(own, grid, size,
             [&](std::size_t at, std::size_t bytes) { mine.insert(mine.end(), values + at, values + at + bytes); });
    for (const std::vector<std::byte>& block : gather(device, mine)) {
        NodeRange theirs;
        std::memcpy(&theirs, block.data(), sizeof theirs);
        const std::byte* from = block.data() + sizeof theirs;
        for_rows(theirs, grid, size, [&](std::size_t at, std::size_t bytes) {
            std::memcpy(values + at, from, bytes);
            from += bytes;
        });
    }
}

}  // namespace chiaro

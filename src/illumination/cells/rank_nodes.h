// Which nodes of a light grid each rank finds, and how all come to know all (Exchange).
#pragma once
#include "illumination/cells/grid.h"

namespace chiaro {

/// Nodes [first, end) along each axis.
struct NodeRange {
    std::array<int, 3> first{0, 0, 0}, end{0, 0, 0};
    bool is_empty() const { return first[0] >= end[0] || first[1] >= end[1] || first[2] >= end[2]; }
    std::size_t row() const { return std::size_t(end[0] - first[0]); }
};

/// Those of which the voxel nearest to the centre is a rank's own: of each node one rank's. All, of a volume that is
/// whole.
NodeRange own_nodes(const DeviceVolume::Data& volume, const CellGrid& grid);

/// Voxels beyond a rank's own that it looks at for the light of its samples: nodes, gradients there; for a surface that
/// a ray has met before it comes to them.
inline constexpr int light_margin = 8;
/// Beyond its own nodes: values of the next cell, gradients, surfaces that begin just before a node.
inline constexpr int node_margin = 4;
/// Throws Error{usage} unless the block reaches so far beyond its own nodes, and `margin` voxels beyond its own ones,
/// or to the volume's border.
void check_ghosts(const DeviceVolume::Data& volume, const CellGrid& grid, int margin = light_margin);

/// Of numbers at the nodes each rank has found its own (`size` bytes each, x fastest); then all have all. Bytes sent:
/// those of a rank's own. For work done `collectively`.
void gather_nodes(const Device& device, const DeviceVolume::Data& volume, const CellGrid& grid, std::byte* values,
                  std::size_t size);
template <class T>
void gather_nodes(const Device& device, const DeviceVolume::Data& volume, const CellGrid& grid, T* values) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (device.is_shared()) gather_nodes(device, volume, grid, reinterpret_cast<std::byte*>(values), sizeof(T));
}

}  // namespace chiaro

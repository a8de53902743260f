// What light is followed through: the extinction of nodes, each standing for a cube of cells.
#pragma once
#include <chiaro/device.h>
#include <chiaro/progress.h>

#include <utility>

#include "illumination/cells/opacity.h"

namespace chiaro {

/// Optical depth of one node's edge, constant in the node; x fastest. Outside the grid there is nothing.
struct Density {
    CellGrid grid;
    MirroredBuffer buffer;

    explicit Density(const CellGrid& nodes) : grid(nodes), buffer(nodes.size() * sizeof(float)) {}
    /// To be written, by one thread while it may lie on a GPU.
    float* numbers() { return reinterpret_cast<float*>(buffer.data()); }
    const float* data() const { return reinterpret_cast<const float*>(std::as_const(buffer).data()); }
    /// Where they are once they have come from a GPU.
    const float* address() const { return reinterpret_cast<const float*>(buffer.address()); }
    const float* on_gpu(cuda::Stream& stream) const { return reinterpret_cast<const float*>(buffer.on_gpu(stream)); }
};

/// Bit for bit: what light meets is the same.
bool is_same(const Density& a, const Density& b);

/// The grid with half as many nodes per axis (rounded up), each at the centre of a block of 2³.
CellGrid halved(const CellGrid& grid);

/// Of blocks of 2³: T the geometric mean over the axes of the mean transmittance of the block's four columns along
/// each, κ = -ln T. Matter outside the grid: none. Throws Error{interrupted}, as all of these do.
Density halved(const Density& finer, const Device& device, Progress& progress);

/// The density for nodes that stand for `subsample`³ cells (1, 2, 4 or 8), of cells whose optical depth is integrated
/// across them (sub_voxel.h). Cost: twice that of `cell_opacity`, which it needs of isosurfaces only, at any subsample;
/// 4 bytes a node.
Density density_for(const Medium::Data& medium, int subsample, const Device& device, Progress& progress);
/// The same of cells classified as points.
Density density_of(const CellOpacity& opacity, int subsample, const Device& device, Progress& progress);

}  // namespace chiaro

// The medium as light meets it: cubic cells, coarse enough to be swept in a frame.
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>

#include <memory>
#include <optional>

#include "illumination/visibility/density.h"

namespace chiaro {

/// A colour for each node: per channel, x fastest. What a GPU made stays there until the host reads it.
struct GridColour {
    std::size_t nodes;
    MirroredBuffer buffer;

    GridColour() : GridColour(0) {}
    explicit GridColour(std::size_t count) : nodes(count), buffer(3 * count * sizeof(float)) {}
    const float* operator[](std::size_t channel) const {
        return reinterpret_cast<const float*>(buffer.data()) + channel * nodes;
    }
    /// To be written.
    float* numbers(std::size_t channel) { return reinterpret_cast<float*>(buffer.data()) + channel * nodes; }
    const float* on_gpu(cuda::Stream& stream) const { return reinterpret_cast<const float*>(buffer.on_gpu(stream)); }
};

/// Of a few nodes, from where they are.
std::vector<std::array<float, 3>> colours_at(const GridColour& colour, const std::vector<std::size_t>& nodes,
                                             const Device& device);

struct LightGrid {
    Density extinction;  ///< optical depth of a cell's edge
    GridColour albedo;
    bool is_isosurface;                       ///< reflects its albedo (Lambert)
    std::vector<std::size_t> boundary_cells;  ///< nodes that a surface leaves mostly open (boundary_cells.h)
    std::optional<Density> surface_share;     ///< of nodes (visibility/surface_share.h); none: all are particles
    /// How far cells resolve skins: 1 up to two voxel edges, .2 from three on, where a cell that is no opaque one is
    /// rather a hard surface's neighbour than a layer of soft matter. Tuned as shown, white and sky: of two voxels
    /// `sample:tubes` with .6 4.8 and 5.1 % from the reference, with 1 3.9 and 4.7; of wider cells with 0, .2 and .27
    /// menger 3.8, 2.3, 2.1 and 3.5, 3.0, 3.2, an engine 3.7, 2.6, 2.5 and 4.3, 3.2, 3.1, a brain 2.1, 1.9, 2.3 and
    /// 6.4, 5.0, 4.7, a bonsai 2.6, 4.1, 4.9 and 5.0, 6.0, 6.4.
    float resolves_skins = 0;
    /// Of nodes half as wide (of two voxels for cells of three), where there are such: what surfaces see of the light
    /// is found from it.
    std::shared_ptr<const Density> finer;

    /// Which part of what an opaque cell answers is its albedo; the rest is what a half space of particles answers.
    double share_of_surface(std::size_t node) const {
        return is_isosurface ? 1 : surface_share ? double(surface_share->data()[node]) : 0;
    }
};

/// At most `cells` on the long axis, each for f³ of the smallest voxels, f of 1, 2, 3, 4, 6, 8, 12 ... Extinction from
/// the mean transmittance of columns, geometric mean over the axes (visibility/density.h); albedo the mean of the
/// classified colours, weighted by extinction, each scaled down to `albedo_max` where a channel is above
/// (docs/theory/transport.md). Cost: that of the density, and a look at every voxel, or where f >= 4 at every second
/// one per axis. Throws Error{interrupted}.
LightGrid light_grid(const Medium::Data& medium, int cells, double albedo_max, const Device& device, Progress& progress,
                     SurfaceModel surfaces = SurfaceModel::none);

}  // namespace chiaro

// Places off a surface: light that arrives at it is read there, by the sample's own normal.
#pragma once
#include "kernel/vec.h"

namespace chiaro::kernel {

struct OffSurface {
    Float3 grid_x, grid_y, grid_z;  ///< unit axes of the voxel grid in the world
    Float3 edge_voxels;             ///< a smallest voxel edge along them

    /// A direction of the world, along the grid's axes.
    template <class F>
    CHIARO_INLINE Vec3<F> along_grid(const Vec3<F>& world) const {
        return {dot(Vec3<F>(grid_x), world), dot(Vec3<F>(grid_y), world), dot(Vec3<F>(grid_z), world)};
    }
    /// `edges` from a place along a direction of the grid.
    template <class F>
    CHIARO_INLINE Vec3<F> place(const Vec3<F>& p_voxel, F edges, const Vec3<F>& way) const {
        return {mad(edges * F(edge_voxels.x), way.x, p_voxel.x), mad(edges * F(edge_voxels.y), way.y, p_voxel.y),
                mad(edges * F(edge_voxels.z), way.z, p_voxel.z)};
    }
    /// As seen by a level whose voxels are those of the field, divided by `scale`.
    void to_level(const Float3& scale) {
        edge_voxels = {edge_voxels.x / scale.x, edge_voxels.y / scale.y, edge_voxels.z / scale.z};
    }
};

}  // namespace chiaro::kernel

namespace chiaro {

struct Geometry;
/// Of the voxels of a volume.
kernel::OffSurface off_surface_of(const Geometry& geometry);

}  // namespace chiaro

// The medium of the ray caster for rays from cells: values interpolated between voxels, then classified.
#pragma once
#include "classify/clip.h"
#include "illumination/reference/extinction.h"
#include "illumination/reference/kernel.h"
#include "volume/device_view.h"

namespace chiaro {

template <class Voxel>
class InterpolatedMedium {
public:
    /// `step` in cell edges.
    InterpolatedMedium(const Medium::Data& medium, const CellGrid& grid, double step)
        : volume_(medium.volume.data()),
          view_(view_of<Voxel>(volume_)),
          grid_(grid),
          table_(extinction_table(medium, grid)),
          kept_(half_spaces(medium.shape.clip, medium.volume.data().geometry, medium.volume.data().dimensions)),
          step_(step) {
        for (int axis = 0; axis < 3; ++axis) {  // light sees whole voxels, and nothing outside
            Vec3 along;
            along[axis] = 1;
            kept_.push_back({-along, 0.5});
            kept_.push_back({along, medium.volume.data().dimensions[axis] - 0.5});
        }
    }

    /// What the kernel reads for one direction; it keeps its planes in `planes`. Rays leave a point `offset` edges off
    /// their cell's centre.
    kernel::InterpolatedRays<Voxel> along(Vec3 direction, double start_half_voxels,
                                          std::vector<kernel::HalfSpaceView>& planes, Vec3 offset = {}) const {
        const Vec3& k = grid_.voxels_per_cell;
        const Vec3 voxels{direction.x * k.x, direction.y * k.y, direction.z * k.z};
        planes.clear();
        for (const HalfSpace& half : kept_)
            planes.push_back({{float(half.normal.x), float(half.normal.y), float(half.normal.z)},
                              float(half.d),
                              float(dot(half.normal, voxels))});
        const double steepest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
        return {.volume = view_,
                .extinction = table_.per_edge.data(),
                .index_scale = table_.index_scale,
                .index_offset = table_.index_offset + 0.5f,
                .last_index = float(table_.per_edge.size() - 1),
                .voxels_per_cell = {float(k.x), float(k.y), float(k.z)},
                .direction = {float(voxels.x), float(voxels.y), float(voxels.z)},
                .origin = {float(0.5 + offset.x), float(0.5 + offset.y), float(0.5 + offset.z)},
                .planes = planes.data(),
                .plane_count = int(planes.size()),
                .start = float(0.5 * start_half_voxels / steepest),
                .step = float(step_),
                .edge_mm = float(grid_.edge_mm)};
    }

    /// What that points into, but for the planes.
    void add_to(HostArrays& arrays) const { volume_.add_to(arrays), arrays.add(table_.per_edge); }

private:
    const DeviceVolume::Data& volume_;
    const kernel::VolumeView<Voxel> view_;
    const CellGrid grid_;
    const ExtinctionTable table_;
    std::vector<HalfSpace> kept_;
    const double step_;
};

}  // namespace chiaro

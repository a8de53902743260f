#include "classify/surface_table.h"

#include <cmath>

#include "volume/float3.h"

namespace chiaro {

SurfaceTable::SurfaceTable(const Medium::Data& medium) {
    const Geometry& geometry = medium.volume.geometry();
    const OpticalTable& table = medium.table;
    const double edge = geometry.smallest_spacing_mm();
    opacity_.reserve(table.entries.size());
    for (const auto& entry : table.entries)
        opacity_.push_back(float(-std::expm1(-double(entry.extinction_per_mm) * edge)));
    // A gradient is a covector: its axes in the world are those of the voxels per mm, here per smallest edge.
    const auto row = [&](Vec3 axis) { return float3(edge * geometry.voxel_from_world_vector(axis)); };
    view_ = {.opacity = nullptr,
             .scale = float(table.index_scale),
             .offset = float(table.index_offset + 0.5),
             .last = float(table.entries.size() - 1),
             .edge_mm = float(edge),
             .world_x = row({1, 0, 0}),
             .world_y = row({0, 1, 0}),
             .world_z = row({0, 0, 1})};
}

std::shared_ptr<const SurfaceTable> surface_table_of(const Medium::Data& medium) {
    return medium.surface_table([&] { return std::make_shared<const SurfaceTable>(medium); });
}

}  // namespace chiaro

// A part of a level of a volume by bricks, as a volume of its own: for what looks at few voxels.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/medium.h>

namespace chiaro {

/// The voxels of a level whose places are within the box, and one more on each side; none where that leaves the level.
VoxelBox box_around(const SourceLevel& level, Vec3 low, Vec3 high);
double voxels_in(const VoxelBox& box);

/// Lies where it lies in the level; its range of values is that of `whole`, a level in memory, or more. Throws as
/// BrickSource::read. Cost: that of reading the box.
DeviceVolume part_of(const BrickSource& source, int level, const VoxelBox& box, const DeviceVolume& whole);

}  // namespace chiaro

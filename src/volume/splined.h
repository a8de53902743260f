// A device volume whose values are those of a cubic B-spline (spline.h).
#pragma once
#include "volume/device_volume.h"

namespace chiaro {

/// The volume with a spline that interpolates its voxels or, with the voxels as coefficients, smooths them: then its
/// voxels are what the spline has there. Its cells hold the ranges of the spline. Made once for each volume, and kept
/// as long as that. Cost: some 20 core-ns a voxel (the row pipeline/splines of chiaro bench), half for floats or to
/// smooth; memory: the bricks once more, the ranges, and some sixty slices of floats while it is made. Throws
/// Error{interrupted} when cancelled.
DeviceVolume splined(const DeviceVolume& volume, bool interpolates, const Progress& progress = Progress());

}  // namespace chiaro

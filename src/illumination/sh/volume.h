// A field of spherical harmonics as a volume, to be kept.
#pragma once
#include <chiaro/device.h>
#include <chiaro/medium.h>
#include <chiaro/progress.h>

#include "illumination/visibility/sh_field.h"

namespace chiaro {

/// One float a coefficient, components first, in the axes of the grid. A field with a node for every cell comes on the
/// volume's own grid, interpolated where voxels are no cubes; a coarser one on its own, nodes at block centres.
Volume volume_of(const Device& device, const ShField& field, const DeviceVolume& volume, Progress& progress);

}  // namespace chiaro

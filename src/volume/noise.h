// How rough a volume is where something is.
#pragma once
#include <chiaro/volume.h>

namespace chiaro {

/// The standard deviation of noise, in data units: the root mean square, over voxels of matter and those beside them,
/// of what a voxel has that its six neighbours have not (Gasser et al. 1986), but for what comes with a gradient, as
/// edges do that the grid resolves; so that it is σ of normal noise. The jagged border of a mask counts as noise.
/// Matter is what lies above `empty`. Of more than 2^24 voxels every n-th slice is read.
double noise_of(const Volume& volume, double empty, const Progress& progress);

}  // namespace chiaro

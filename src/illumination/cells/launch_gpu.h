// Opacity as a GPU has it, compiled by launch_opacity.cu; pointers are the GPU's.
#pragma once
#include "cuda/stream.h"
#include "illumination/cells/opacity_kernel.h"

namespace chiaro::kernel {

/// A thread for each cell.
template <class Voxel>
CHIARO_LAUNCHER void fill_opacities(cuda::Stream& stream, const OpacityBatch<Voxel>& batch, std::int64_t blocks);

}  // namespace chiaro::kernel

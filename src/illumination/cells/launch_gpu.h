// Opacity and lifting as a GPU has them, compiled by launch_opacity.cu and launch_normal_offset.cu; pointers are the
// GPU's.
#pragma once
#include "cuda/stream.h"
#include "illumination/cells/kernel.h"
#include "illumination/cells/opacity_kernel.h"

namespace chiaro::kernel {

/// A thread for each cell.
template <class Voxel>
CHIARO_LAUNCHER void fill_opacities(cuda::Stream& stream, const OpacityBatch<Voxel>& batch, std::int64_t blocks);

/// Tiles, then answers: a thread for each cell.
CHIARO_LAUNCHER void normal_offset_blocks(cuda::Stream& stream, const NormalOffsetBatch& batch, std::int64_t blocks);

}  // namespace chiaro::kernel

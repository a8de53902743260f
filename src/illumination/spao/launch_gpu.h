// The kernels of SPAO as a GPU has them, compiled by launch_fused.cu and launch_stored.cu; pointers are the GPU's.
#pragma once
#include "cuda/stream.h"
#include "illumination/spao/batch_kernel.h"

namespace chiaro::kernel {

/// A thread for each cell; `Source` is one of those of batch_kernel.h.
template <class Source>
CHIARO_LAUNCHER void fill_grid(cuda::Stream& stream, const Source& source, const GridTarget& target);

/// Tiles and their means, then answers: a thread for each cell, or corner of a coarser grid.
CHIARO_LAUNCHER void result_cells(cuda::Stream& stream, const SpaoBatch& batch, std::int64_t blocks);
CHIARO_LAUNCHER void result_corners(cuda::Stream& stream, const SpaoBatch& batch, std::int64_t blocks);
template <class Kernel>
CHIARO_LAUNCHER void result_access(cuda::Stream& stream, const AccessBatch<Kernel>& batch, std::int64_t blocks);

CHIARO_LAUNCHER void sum_up(cuda::Stream& stream, const SumTable& table);

}  // namespace chiaro::kernel

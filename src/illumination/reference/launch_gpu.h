// The reference's rays as a GPU has them, compiled by launch.cu; pointers are the GPU's.
#pragma once
#include "cuda/stream.h"
#include "illumination/reference/harmonics.h"

namespace chiaro::kernel {

/// Rows of columns that a thread takes each, whether all are there or not: those of a block.
inline constexpr std::int32_t column_rows = 32, column_nodes = NodeColumn::width * column_rows * column_rows;

/// A thread for each node.
template <class Rays>
CHIARO_LAUNCHER void trace_columns(cuda::Stream& stream, const RayKernel<Rays>& kernel, const NodeColumn* columns,
                                   std::int64_t count);
/// A thread for each run: its sums are its own.
template <class Rays>
CHIARO_LAUNCHER void trace_harmonics(cuda::Stream& stream, const HarmonicsKernel<Rays>& kernel, const NodeRun* runs,
                                     std::int64_t count, HarmonicSums* sums);

}  // namespace chiaro::kernel

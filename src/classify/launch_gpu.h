// The kernels of occupancy as a GPU has them, compiled by launch_occupancy.cu; pointers are the GPU's.
#pragma once
#include "classify/occupancy_kernel.h"
#include "cuda/stream.h"

namespace chiaro::kernel {

/// A thread for each cell.
CHIARO_LAUNCHER void begin_occupancy(cuda::Stream& stream, const CellValueRanges& ranges, const OccupancyPass& pass);
CHIARO_LAUNCHER void spread_occupancy(cuda::Stream& stream, const OccupancyPass& pass, std::int64_t stride,
                                      std::int32_t n);
CHIARO_LAUNCHER void write_occupancy(cuda::Stream& stream, const OccupancyPass& pass, std::uint8_t* codes);

}  // namespace chiaro::kernel

// The path tracer's kernels as a GPU has them, compiled by launch.cu.
#pragma once
#include "cuda/counters.h"
#include "pathtrace/kernel.h"
#include "pathtrace/pixel_sum.h"

namespace chiaro::kernel {

/// A path for each pixel of the frame, added to `sums`; collisions are counted. Pointers are the GPU's.
template <class Kernel>
CHIARO_LAUNCHER void trace_frame(cuda::Stream& stream, const Kernel& kernel, std::int32_t width, std::int32_t height,
                                 std::int32_t sample, PixelSum* sums, cuda::Count* collisions);

}  // namespace chiaro::kernel

// Kernels of one item, as hosts start them; a launch*.cu names those that there are.
#pragma once
#include "cuda/stream.h"

namespace chiaro::kernel {

/// kernel(i) for each i of [0, count), a thread each; pointers are the GPU's.
template <class Kernel>
CHIARO_LAUNCHER void run_on_gpu(cuda::Stream& stream, std::int64_t count, const Kernel& kernel);

}  // namespace chiaro::kernel

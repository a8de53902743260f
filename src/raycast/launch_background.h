// The background as a GPU has it, compiled by launch_background.cu; pointers are the GPU's.
#pragma once
#include "cuda/stream.h"
#include "raycast/background_kernel.h"

namespace chiaro::kernel {

/// A thread for each pixel.
CHIARO_LAUNCHER void put_background(cuda::Stream& stream, const BackgroundKernel& kernel, std::int32_t width,
                                    std::int32_t height);

}  // namespace chiaro::kernel

// Developing as a card has it, compiled by launch_develop.cu; pointers are the card's.
#pragma once
#include "cuda/stream.h"
#include "image/develop_kernel.h"

namespace chiaro::kernel {

/// A thread for each pixel.
template <class Encode>
void develop_pixels(cuda::Stream& stream, const DevelopKernel<Encode>& kernel, std::int64_t count);

}  // namespace chiaro::kernel

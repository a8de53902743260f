// The kernels of transport as a card has them, compiled by launch_card.cu.
#pragma once
#include "cuda/stream.h"
#include "illumination/transport/card_kernel.h"
#include "illumination/transport/colour_kernel.h"
#include "illumination/transport/light_kernel.h"
#include "illumination/transport/opaque_kernel.h"
#include "illumination/transport/skin_kernel.h"
#include "illumination/transport/third_kernel.h"

namespace chiaro::kernel {

/// kernel(i) for each i of [0, count), a thread each.
template <class Kernel>
void run_on_card(cuda::Stream& stream, std::int64_t count, const Kernel& kernel);

}  // namespace chiaro::kernel

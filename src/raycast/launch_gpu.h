// The ray caster's kernels as a GPU has them; compiled by launch_*.cu (launch_pixels.h).
#pragma once
#include "cuda/counters.h"
#include "raycast/kernel.h"
#include "volume/texture_view.h"

namespace chiaro::kernel {

/// Starts a thread for each pixel of the tile. The kernel's pointers are the GPU's; samples are counted.
template <class Kernel>
CHIARO_LAUNCHER void cast_pixels(cuda::Stream& stream, const Kernel& kernel, Tile tile, cuda::Count* samples);

}  // namespace chiaro::kernel

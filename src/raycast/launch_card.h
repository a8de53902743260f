// The ray caster's kernels as a card has them; compiled by launch_*.cu (launch_pixels.h).
#pragma once
#include "cuda/stream.h"
#include "raycast/kernel.h"

namespace chiaro::kernel {

using SampleCount = unsigned long long;
inline constexpr std::int32_t sample_counts = 1024;  ///< so many that threads do not wait for each other

/// Starts a thread for each pixel of the tile. The kernel's pointers are the card's; samples are added to `samples`,
/// [sample_counts].
template <class Kernel>
void cast_pixels(cuda::Stream& stream, const Kernel& kernel, Tile tile, SampleCount* samples);

}  // namespace chiaro::kernel

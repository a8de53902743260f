// The path tracer's kernels as a card has them, compiled by launch.cu.
#pragma once
#include "cuda/stream.h"
#include "pathtrace/kernel.h"
#include "pathtrace/pixel_sum.h"

namespace chiaro::kernel {

using CollisionCount = unsigned long long;
inline constexpr std::int32_t collision_counts = 1024;  ///< so many that threads do not wait for each other

/// A path for each pixel of the frame, added to `sums`; collisions are added to `collisions`, [collision_counts].
/// Pointers are the card's.
template <class Kernel>
void trace_frame(cuda::Stream& stream, const Kernel& kernel, std::int32_t width, std::int32_t height,
                 std::int32_t sample, PixelSum* sums, CollisionCount* collisions);

}  // namespace chiaro::kernel

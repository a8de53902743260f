// Lifting as a card has it, compiled by launch_lift.cu; pointers are the card's.
#pragma once
#include "cuda/stream.h"
#include "illumination/cells/kernel.h"

namespace chiaro::kernel {

/// Tiles, then answers: a thread for each cell.
void lift_blocks(cuda::Stream& stream, const LiftBatch& batch, std::int64_t blocks);

}  // namespace chiaro::kernel

// The sweep's kernel as a card has it, compiled by launch_sweep.cu.
#pragma once
#include "cuda/stream.h"
#include "illumination/visibility/sweep_kernel.h"

namespace chiaro::kernel {

/// A plane of nodes; pointers are the card's.
struct SweptPlane {
    std::int32_t nu, nv;
    std::int64_t stride_u, stride_v;  ///< nodes of the grid
    const float* density;             ///< of the plane's first node in the grid
    float* field;                     ///< its coefficients
    float* scratch;                   ///< [v][u][direction]
};

/// A thread for each node: within a plane none needs another.
void sweep_plane(cuda::Stream& stream, const SweepKernel& kernel, const SweptPlane& plane);

}  // namespace chiaro::kernel

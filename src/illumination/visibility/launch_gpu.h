// The kernels of visibility as a GPU has them, compiled by launch_*.cu.
#pragma once
#include "cuda/run.h"
#include "illumination/visibility/density_kernel.h"
#include "illumination/visibility/gpu_kernel.h"
#include "illumination/visibility/node_kernel.h"
#include "illumination/visibility/pyramid_kernel.h"
#include "illumination/visibility/walk_kernel.h"

namespace chiaro::kernel {

CHIARO_LAUNCHER void keep_all_nodes(cuda::Stream& stream, const KeepKernel& kernel, std::int64_t nodes);
CHIARO_LAUNCHER void light_all_nodes(cuda::Stream& stream, const LightKernel& kernel, std::int64_t nodes);

}  // namespace chiaro::kernel

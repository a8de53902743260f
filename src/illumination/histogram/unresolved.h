// Histograms that are left over for another kernel, for launch*.cu alone.
#pragma once
#include "cuda/launch.h"
#include "illumination/histogram/launch_gpu.h"

namespace chiaro::kernel {

CHIARO_DEVICE void leave_unresolved(const Unresolved& left, std::int64_t i) {
    left.which[atomicAdd(left.count, cuda::Count(1))] = std::uint32_t(i);
}

}  // namespace chiaro::kernel

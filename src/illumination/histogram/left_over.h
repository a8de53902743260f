// Histograms that are left over for another kernel, for launch*.cu alone.
#pragma once
#include "cuda/launch.h"
#include "illumination/histogram/launch_card.h"

namespace chiaro::kernel {

CHIARO_ON_CARD void leave_over(const LeftOver& left, std::int64_t i) {
    left.which[atomicAdd(left.count, cuda::Count(1))] = std::uint32_t(i);
}

}  // namespace chiaro::kernel

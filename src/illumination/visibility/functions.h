// The kernels of visibility, by instruction set.
#pragma once
#include "illumination/visibility/sweep_kernel.h"

namespace chiaro::kernel {

struct VisibilityFunctions {
    void (*sweep_row)(const SweepKernel&, const SweepRow&);
};

}  // namespace chiaro::kernel

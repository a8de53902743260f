// The kernels of splines, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "volume/spline_functions.h"

namespace chiaro::kernel {

CHIARO_KERNEL_TABLE(SplineFunctions, spline_functions)

}  // namespace chiaro::kernel

// The kernels of visibility, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/visibility/functions.h"

namespace chiaro::kernel {

CHIARO_KERNEL_TABLE(VisibilityFunctions, visibility_functions)

}  // namespace chiaro::kernel

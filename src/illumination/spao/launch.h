// The kernels of SPAO, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/spao/functions.h"

namespace chiaro::kernel {

CHIARO_KERNEL_TABLE(SpaoFunctions, spao_functions)

}  // namespace chiaro::kernel

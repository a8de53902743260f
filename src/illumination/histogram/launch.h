// The kernels of local histograms, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/histogram/functions.h"

namespace chiaro::kernel {

CHIARO_KERNEL_TABLE(HistogramFunctions, histogram_functions)

}  // namespace chiaro::kernel

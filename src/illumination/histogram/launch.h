// The kernels of local histograms, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/histogram/functions.h"

namespace chiaro::kernel {

#define CHIARO_DECLARE(isa)                   \
    namespace isa {                           \
    HistogramFunctions histogram_functions(); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

inline HistogramFunctions histogram_functions_for(Isa isa) { return CHIARO_PICK(isa, histogram_functions)(); }

}  // namespace chiaro::kernel

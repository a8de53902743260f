// The kernels of visibility, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/visibility/functions.h"

namespace chiaro::kernel {

#define CHIARO_DECLARE(isa)                     \
    namespace isa {                             \
    VisibilityFunctions visibility_functions(); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

inline VisibilityFunctions visibility_functions_for(Isa isa) { return CHIARO_PICK(isa, visibility_functions)(); }

}  // namespace chiaro::kernel

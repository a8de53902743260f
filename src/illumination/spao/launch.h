// The kernels of SPAO, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/spao/functions.h"

namespace chiaro::kernel {

#define CHIARO_DECLARE(isa)         \
    namespace isa {                 \
    SpaoFunctions spao_functions(); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

inline SpaoFunctions spao_functions_for(Isa isa) { return CHIARO_PICK(isa, spao_functions)(); }

}  // namespace chiaro::kernel

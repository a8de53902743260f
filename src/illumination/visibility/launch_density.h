// Rows of density, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/visibility/rows.h"

namespace chiaro::kernel {

#define CHIARO_DECLARE(isa)     \
    namespace isa {             \
    DensityRows density_rows(); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

inline DensityRows density_rows_for(Isa isa) { return CHIARO_PICK(isa, density_rows)(); }

}  // namespace chiaro::kernel

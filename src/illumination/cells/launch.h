// The kernels over rows of cells, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/cells/kernel.h"

namespace chiaro::kernel {

#define CHIARO_DECLARE(isa)                                             \
    namespace isa {                                                     \
    void normal_offset_cells(const NormalOffsetBlock&, float* numbers); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

inline auto normal_offset_block_for(Isa isa) { return CHIARO_PICK(isa, normal_offset_cells); }

}  // namespace chiaro::kernel

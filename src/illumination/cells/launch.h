// The kernels over rows of cells, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/cells/kernel.h"

namespace chiaro::kernel {

using NormalOffsetBlock = void (*)(float* access, const float* opacity, float normal_factor,
                                   const std::uint8_t (*pieces)[8], std::uint16_t* out);

#define CHIARO_DECLARE(isa)                                                                           \
    namespace isa {                                                                                   \
    void normal_offset_cells(float*, const float*, float, const std::uint8_t (*)[8], std::uint16_t*); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

inline NormalOffsetBlock normal_offset_block_for(Isa isa) { return CHIARO_PICK(isa, normal_offset_cells); }

}  // namespace chiaro::kernel

// The walk through the pyramid, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/visibility/walk_kernel.h"

namespace chiaro::kernel {

#define CHIARO_DECLARE(isa)                                                                 \
    namespace isa {                                                                         \
    void walk(const WalkKernel&, Float3, const LaneDirections*, std::int32_t, std::int32_t, \
              float (*)[LaneDirections::width]);                                            \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

inline WalkFunction walk_for(Isa isa) { return CHIARO_PICK(isa, walk); }

}  // namespace chiaro::kernel

// The floor's light, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/floor/light_kernel.h"

namespace chiaro::kernel {

#define CHIARO_DECLARE(isa)                                                                           \
    namespace isa {                                                                                   \
    void light_floor_points(const FloorLightKernel&, const FloorPoints&, std::int64_t, std::int64_t); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

/// Points [first, end), a multiple of sixteen.
inline FloorLightFunction light_floor_for(Isa isa) { return CHIARO_PICK(isa, light_floor_points); }

}  // namespace chiaro::kernel

// The first lane that a mask holds.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// Of a mask that holds at least one lane.
CHIARO_INLINE int first_of(bool) { return 0; }

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {
CHIARO_INLINE int first_of(MaskLanes m) { return __builtin_ctz(mask_bits(m.bits)); }
}  // namespace CHIARO_ISA
#endif

}  // namespace chiaro::kernel

#include "illumination/histogram/field.h"
#include "raycast/launch_kinds.h"

namespace chiaro::kernel::CHIARO_ISA {
CHIARO_INSTANTIATE(HistogramView)
}  // namespace chiaro::kernel::CHIARO_ISA

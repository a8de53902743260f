#include "illumination/none/field.h"
#include "raycast/launch_kinds.h"

namespace chiaro::kernel::CHIARO_ISA {
CHIARO_INSTANTIATE(NoneView)
CHIARO_INSTANTIATE_PAGED(NoneView)
}  // namespace chiaro::kernel::CHIARO_ISA

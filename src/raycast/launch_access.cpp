#include "illumination/cells/field.h"
#include "raycast/launch_kinds.h"

namespace chiaro::kernel::CHIARO_ISA {
CHIARO_INSTANTIATE(AccessView)
CHIARO_INSTANTIATE_PAGED(AccessView)
}  // namespace chiaro::kernel::CHIARO_ISA

#include "illumination/visibility/field.h"
#include "raycast/launch_kinds.h"

namespace chiaro::kernel::CHIARO_ISA {
CHIARO_INSTANTIATE(VisibilityView)
CHIARO_INSTANTIATE_PAGED(VisibilityView)
}  // namespace chiaro::kernel::CHIARO_ISA

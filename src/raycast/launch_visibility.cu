#include "illumination/visibility/field.h"
#include "raycast/launch_pixels.h"

namespace chiaro::kernel {
CHIARO_INSTANTIATE(VisibilityView)
}  // namespace chiaro::kernel

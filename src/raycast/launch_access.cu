#include "illumination/cells/field.h"
#include "raycast/launch_pixels.h"

namespace chiaro::kernel {
CHIARO_INSTANTIATE(AccessView)
}  // namespace chiaro::kernel

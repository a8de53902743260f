#include "illumination/none/field.h"
#include "raycast/launch_pixels.h"

namespace chiaro::kernel {
CHIARO_INSTANTIATE(NoneView)
}  // namespace chiaro::kernel

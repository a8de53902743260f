#include "illumination/histogram/field.h"
#include "raycast/launch_pixels.h"

namespace chiaro::kernel {
CHIARO_INSTANTIATE(HistogramView)
}  // namespace chiaro::kernel

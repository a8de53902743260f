#include "pathtrace/launch_kinds.h"

namespace chiaro::kernel::CHIARO_ISA {
CHIARO_INSTANTIATE(SurfaceCloud)
}  // namespace chiaro::kernel::CHIARO_ISA

#include "pathtrace/launch_kinds.h"

namespace chiaro::kernel::CHIARO_ISA {
CHIARO_INSTANTIATE(Surfaces)
}  // namespace chiaro::kernel::CHIARO_ISA

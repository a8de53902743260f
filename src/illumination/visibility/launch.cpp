#include "kernel/launch.h"
#include "illumination/visibility/functions.h"

namespace chiaro::kernel::CHIARO_ISA {

VisibilityFunctions visibility_functions() {
    return {[](const SweepKernel& kernel, const SweepRow& row) { kernel.operator()<NativeLanes>(row); }};
}

}  // namespace chiaro::kernel::CHIARO_ISA

#include "illumination/visibility/walk_kernel.h"
#include "kernel/launch.h"

namespace chiaro::kernel::CHIARO_ISA {

void walk(const WalkKernel& kernel, Float3 first_node, const LaneDirections* directions, std::int32_t direction_count,
          std::int32_t coefficients, float (*sums)[LaneDirections::width]) {
    walk_run<NativeLanes>(kernel, first_node, directions, direction_count, coefficients, sums);
}

}  // namespace chiaro::kernel::CHIARO_ISA

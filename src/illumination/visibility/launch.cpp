#include "kernel/launch.h"
#include "illumination/visibility/functions.h"

namespace chiaro::kernel::CHIARO_ISA {

VisibilityFunctions visibility_functions() {
    return {
        [](const SweepKernel& kernel, const SweepRow& row) { kernel.operator()<NativeLanes>(row); },
        [](const ShearedKernel& kernel, const ShearedRow& row) { kernel.operator()<NativeLanes>(row); },
        [](const KeepKernel& kernel, std::int64_t first, std::int32_t count) {
            kernel.operator()<NativeLanes>(first, count);
        },
        [](const AddSteps& kernel, float* parts, std::int32_t count, std::uint16_t* to, std::int64_t stride) {
            kernel.operator()<NativeLanes>(parts, count, to, stride);
        },
        [](const LightKernel& kernel, std::int64_t first, std::int32_t count) { kernel(first, count); },
    };
}

}  // namespace chiaro::kernel::CHIARO_ISA

#include "illumination/visibility/rows.h"
#include "kernel/launch.h"

namespace chiaro::kernel::CHIARO_ISA {

DensityRows density_rows() {
    return {
        [](const float* depth, std::int32_t count, float* to) { transmittance_row<NativeLanes>(depth, count, to); },
        [](const FourRows& rows, std::int32_t nodes, float* to) { halve_row<NativeLanes>(rows, nodes, to); },
    };
}

}  // namespace chiaro::kernel::CHIARO_ISA

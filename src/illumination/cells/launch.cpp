#include "illumination/cells/kernel.h"

namespace chiaro::kernel::CHIARO_ISA {

void normal_offset_cells(float* access, const float* opacity, float normal_factor, const std::uint8_t (*pieces)[8],
                         std::uint16_t* out) {
    normal_offset_block(access, opacity, normal_factor, pieces, out);
}

}  // namespace chiaro::kernel::CHIARO_ISA

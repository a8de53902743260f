#include "kernel/launch.h"
#include "illumination/cells/kernel.h"

namespace chiaro::kernel::CHIARO_ISA {

void normal_offset_cells(const NormalOffsetBlock& block, float* numbers) {
    normal_offset_block<NativeLanes>(block, numbers);
}

}  // namespace chiaro::kernel::CHIARO_ISA

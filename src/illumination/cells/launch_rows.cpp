#include "illumination/cells/row_functions.h"
#include "kernel/launch.h"

namespace chiaro::kernel::CHIARO_ISA {
namespace {

template <class Voxel>
RowFunctions<Voxel> functions_of() {
    return {[](const VolumeView<Voxel>& volume, const ValueRow& row) { find_values<NativeLanes>(volume, row); },
            [](const CellOpacityKernel<Voxel>& kernel, const ValueRow& row, bool near_surface) {
                kernel.template find_inside<NativeLanes>(row, near_surface);
            }};
}

}  // namespace

CellFunctions cell_functions() {
    return {functions_of<std::uint8_t>(), functions_of<std::uint16_t>(), functions_of<float>()};
}

}  // namespace chiaro::kernel::CHIARO_ISA

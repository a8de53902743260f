#include "illumination/cells/value_row.h"
#include "kernel/launch.h"

namespace chiaro::kernel::CHIARO_ISA {

template <class Voxel>
void value_row(const VolumeView<Voxel>& volume, const ValueRow& row) {
    find_values<NativeLanes>(volume, row);
}

template void value_row(const VolumeView<std::uint8_t>&, const ValueRow&);
template void value_row(const VolumeView<std::uint16_t>&, const ValueRow&);
template void value_row(const VolumeView<float>&, const ValueRow&);

}  // namespace chiaro::kernel::CHIARO_ISA

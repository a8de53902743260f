// What of cells is compiled once per instruction set.
#pragma once
#include "illumination/cells/opacity_kernel.h"

namespace chiaro::kernel {

/// Of volumes that are stored as `Voxel`.
template <class Voxel>
struct RowFunctions {
    void (*find_values)(const VolumeView<Voxel>&, const ValueRow&);
    void (*find_inside)(const CellOpacityKernel<Voxel>&, const ValueRow&, bool near_surface);
};
struct CellFunctions : RowFunctions<std::uint8_t>, RowFunctions<std::uint16_t>, RowFunctions<float> {};

}  // namespace chiaro::kernel

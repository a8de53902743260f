// Shares of surface, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/visibility/surface_share_kernel.h"

namespace chiaro::kernel {

template <class Voxel>
using ShareRow = void (*)(const SurfaceShareKernel<Voxel>&, std::int32_t y, std::int32_t z);

#define CHIARO_DECLARE(isa)                                                           \
    namespace isa {                                                                   \
    template <class Voxel>                                                            \
    void share_row(const SurfaceShareKernel<Voxel>&, std::int32_t y, std::int32_t z); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

/// A row of nodes along x.
template <class Voxel>
ShareRow<Voxel> share_row_for(Isa isa) {
    return CHIARO_PICK(isa, share_row<Voxel>);
}

}  // namespace chiaro::kernel

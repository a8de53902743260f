// Values between voxels, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "illumination/cells/value_row.h"

namespace chiaro::kernel {

template <class Voxel>
using FindValues = void (*)(const VolumeView<Voxel>&, const ValueRow&);

#define CHIARO_DECLARE(isa)                                    \
    namespace isa {                                            \
    template <class Voxel>                                     \
    void value_row(const VolumeView<Voxel>&, const ValueRow&); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

template <class Voxel>
FindValues<Voxel> value_row_for(Isa isa) {
    return CHIARO_PICK(isa, value_row<Voxel>);
}

}  // namespace chiaro::kernel

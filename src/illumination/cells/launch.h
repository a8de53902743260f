// The kernels over rows of cells, compiled once per instruction set.
#pragma once
#include <chiaro/device.h>

#include "illumination/cells/kernel.h"

namespace chiaro::kernel {

using LiftBlock = void (*)(float* access, const float* opacity, float normal_factor, const std::uint8_t (*pieces)[8],
                           std::uint16_t* out);

#define CHIARO_DECLARE(isa)                                                                  \
    namespace isa {                                                                          \
    void lift_cells(float*, const float*, float, const std::uint8_t (*)[8], std::uint16_t*); \
    }
CHIARO_DECLARE(scalar)
CHIARO_DECLARE(x86_64_v2)
CHIARO_DECLARE(x86_64_v3)
CHIARO_DECLARE(x86_64_v4)
#undef CHIARO_DECLARE

inline LiftBlock lift_block_for(Isa isa) {
    constexpr LiftBlock blocks[] = {scalar::lift_cells, x86_64_v2::lift_cells, x86_64_v3::lift_cells,
                                    x86_64_v4::lift_cells};
    return blocks[int(isa)];
}

}  // namespace chiaro::kernel

// The ray caster's kernel, compiled once per instruction set.
#pragma once
#include "core/isa.h"
#include "raycast/kernel.h"

namespace chiaro::kernel {

template <class Kernel>
using TileFunction = std::int64_t (*)(const Kernel&, Tile);

#define CHIARO_DECLARE(isa)                         \
    namespace isa {                                 \
    template <class Kernel>                         \
    std::int64_t raycast_tile(const Kernel&, Tile); \
    }
CHIARO_FOR_EACH_ISA(CHIARO_DECLARE)
#undef CHIARO_DECLARE

template <class Kernel>
TileFunction<Kernel> raycast_tile_for(Isa isa) {
    return CHIARO_PICK(isa, raycast_tile<Kernel>);
}

}  // namespace chiaro::kernel

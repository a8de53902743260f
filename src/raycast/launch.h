// The ray caster's kernel, compiled once per instruction set.
#pragma once
#include <chiaro/device.h>

#include "raycast/kernel.h"

namespace chiaro::kernel {

template <class Kernel>
using TileFunction = std::int64_t (*)(const Kernel&, Tile);

// Defined in launch.cpp, one namespace per instruction set.
namespace scalar {
template <class Kernel>
std::int64_t raycast_tile(const Kernel&, Tile);
}
namespace x86_64_v2 {
template <class Kernel>
std::int64_t raycast_tile(const Kernel&, Tile);
}
namespace x86_64_v3 {
template <class Kernel>
std::int64_t raycast_tile(const Kernel&, Tile);
}
namespace x86_64_v4 {
template <class Kernel>
std::int64_t raycast_tile(const Kernel&, Tile);
}

template <class Kernel>
TileFunction<Kernel> raycast_tile_for(Isa isa) {
    switch (isa) {
        case Isa::scalar:
            return scalar::raycast_tile<Kernel>;
        case Isa::x86_64_v2:
            return x86_64_v2::raycast_tile<Kernel>;
        case Isa::x86_64_v3:
            return x86_64_v3::raycast_tile<Kernel>;
        default:
            return x86_64_v4::raycast_tile<Kernel>;
    }
}

}  // namespace chiaro::kernel

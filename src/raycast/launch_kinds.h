// What each launch_*.cpp compiles: the ray caster for one kind of field. A unit each, because one takes minutes.
#pragma once
#include "raycast/kernel.h"
#include "volume/paged_view.h"

namespace chiaro::kernel::CHIARO_ISA {

template <class Kernel>
std::int64_t raycast_tile(const Kernel& kernel, Tile tile) {
    return run_tile<NativeLanes>(kernel, tile);
}

#define CHIARO_INSTANTIATE(Field)                                                         \
    template std::int64_t raycast_tile(const RaycastKernel<std::uint8_t, Field>&, Tile);  \
    template std::int64_t raycast_tile(const RaycastKernel<std::uint16_t, Field>&, Tile); \
    template std::int64_t raycast_tile(const RaycastKernel<float, Field>&, Tile);
/// Of levels by bricks.
#define CHIARO_INSTANTIATE_PAGED(Field) template std::int64_t raycast_tile(const RaycastKernel<Paged, Field>&, Tile);

}  // namespace chiaro::kernel::CHIARO_ISA

#include "raycast/launch_kinds.h"
#include "raycast/value_kernel.h"

namespace chiaro::kernel::CHIARO_ISA {
template std::int64_t raycast_tile(const ValueKernel<std::uint8_t>&, Tile);
template std::int64_t raycast_tile(const ValueKernel<std::uint16_t>&, Tile);
template std::int64_t raycast_tile(const ValueKernel<float>&, Tile);
}  // namespace chiaro::kernel::CHIARO_ISA

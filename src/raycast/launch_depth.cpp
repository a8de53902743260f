#include "raycast/depth_kernel.h"
#include "raycast/launch_kinds.h"

namespace chiaro::kernel::CHIARO_ISA {
template std::int64_t raycast_tile(const DepthKernel<std::uint8_t>&, Tile);
template std::int64_t raycast_tile(const DepthKernel<std::uint16_t>&, Tile);
template std::int64_t raycast_tile(const DepthKernel<float>&, Tile);
}  // namespace chiaro::kernel::CHIARO_ISA

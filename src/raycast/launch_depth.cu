#include "raycast/depth_kernel.h"
#include "raycast/launch_pixels.h"

namespace chiaro::kernel {
template void cast_pixels(cuda::Stream&, const DepthKernel<std::uint8_t>&, Tile, cuda::Count*);
template void cast_pixels(cuda::Stream&, const DepthKernel<std::uint16_t>&, Tile, cuda::Count*);
template void cast_pixels(cuda::Stream&, const DepthKernel<float>&, Tile, cuda::Count*);
}  // namespace chiaro::kernel

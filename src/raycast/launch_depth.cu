#include "raycast/launch_pixels.h"  // first: it silences a false alarm of nvcc

#include "raycast/depth_kernel.h"

namespace chiaro::kernel {
template void cast_pixels(cuda::Stream&, const DepthKernel<std::uint8_t>&, Tile, cuda::Count*);
template void cast_pixels(cuda::Stream&, const DepthKernel<std::uint16_t>&, Tile, cuda::Count*);
template void cast_pixels(cuda::Stream&, const DepthKernel<float>&, Tile, cuda::Count*);
}  // namespace chiaro::kernel

// Shares of surface on GPUs: a thread a node.
#include "cuda/each_node.h"
#include "cuda/launch.h"
#include "illumination/visibility/surface_share_kernel.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<SurfaceShareKernel<std::uint8_t>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<SurfaceShareKernel<std::uint16_t>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<SurfaceShareKernel<float>>&);

}  // namespace chiaro::kernel

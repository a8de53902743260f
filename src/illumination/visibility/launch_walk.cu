// The pyramid and the walk through it on GPUs: the same source, one thread a node.
#include "cuda/launch.h"
#include "illumination/visibility/launch_gpu.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const FinestLevel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const NextLevel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const WalkNode&);

}  // namespace chiaro::kernel

// What is told of a frame's sums on GPUs: the same source, a thread a pixel or a run of them.
#include "cuda/launch.h"
#include "pathtrace/sums_kernel.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const MeanKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const NoiseKernel&);

}  // namespace chiaro::kernel

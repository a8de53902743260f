// Developing on GPUs: the same source, a thread a pixel.
#include "cuda/launch.h"
#include "image/develop_kernel.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const DevelopKernel<SrgbCode>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const DevelopKernel<RoundToByte>&);

}  // namespace chiaro::kernel

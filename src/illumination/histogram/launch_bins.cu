// Bins of cells on GPUs: the same source, a thread a cell.
#include "cuda/launch.h"
#include "illumination/histogram/bin_kernel.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const BinKernel<std::uint8_t>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const BinKernel<std::uint16_t>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const BinKernel<float>&);

}  // namespace chiaro::kernel

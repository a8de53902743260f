// Histograms by brute force and of moving balls on GPUs: the same source, a thread a ball or a row.
#include "cuda/launch.h"
#include "illumination/histogram/slab_source.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const PlaceCells&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const CountSlab&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const PackSlab&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const SweepSlab&);

}  // namespace chiaro::kernel

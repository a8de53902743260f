// The medium of sweeps, and a sun in it, on GPUs: the same source, a thread a cell.
#include "cuda/launch.h"
#include "illumination/transport/dominant_light_kernel.h"
#include "illumination/transport/matter_kernel.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const LatticeKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const HalvedAlbedoKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const GatherKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const NearestKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const DominantLightShareKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const DominantLightFacesKernel&);

}  // namespace chiaro::kernel

// The medium of sweeps on cards: the same source, a thread a cell.
#include "cuda/launch.h"
#include "illumination/transport/matter_kernel.h"

namespace chiaro::kernel {

template void run_on_card(cuda::Stream&, std::int64_t, const LatticeKernel&);
template void run_on_card(cuda::Stream&, std::int64_t, const HalvedAlbedoKernel&);
template void run_on_card(cuda::Stream&, std::int64_t, const GatherKernel&);
template void run_on_card(cuda::Stream&, std::int64_t, const NearestKernel&);

}  // namespace chiaro::kernel

// Sweeps on GPUs: the same source, one thread a node and direction, then one a node and coefficient.
#include "cuda/launch.h"
#include "illumination/visibility/launch_gpu.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const StartSides<GridSide>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const TravelSides<GridSide>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const ProjectSides<GridSide>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const StartSides<ShearedSide>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const TravelSides<ShearedSide>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const ProjectSides<ShearedSide>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const AddParts&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const AddStepParts&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const SpreadKernel&);

}  // namespace chiaro::kernel

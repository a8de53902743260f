// Extinction of cells on GPUs: the same source, a thread a row of a block.
#include "cuda/launch.h"
#include "illumination/reference/extinction_kernel.h"

namespace chiaro::kernel {

#define CHIARO_INSTANTIATE(Extinction) \
    template void run_on_gpu(cuda::Stream&, std::int64_t, const FillExtinction<Extinction>&);
CHIARO_INSTANTIATE(CellExtinction<std::uint8_t>)
CHIARO_INSTANTIATE(CellExtinction<std::uint16_t>)
CHIARO_INSTANTIATE(CellExtinction<float>)
CHIARO_INSTANTIATE(NodeExtinction)
#undef CHIARO_INSTANTIATE

}  // namespace chiaro::kernel

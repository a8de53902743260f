// Opacity of cells on GPUs: the same source, one thread a cell.
#include "cuda/launch.h"
#include "illumination/cells/launch_gpu.h"

namespace chiaro::kernel {

template <class Voxel>
void fill_opacities(cuda::Stream& stream, const OpacityBatch<Voxel>& batch, std::int64_t blocks) {
    cuda::launch_items(stream, blocks * BlockPlace::cells, batch);
}

template void fill_opacities(cuda::Stream&, const OpacityBatch<std::uint8_t>&, std::int64_t);
template void fill_opacities(cuda::Stream&, const OpacityBatch<std::uint16_t>&, std::int64_t);
template void fill_opacities(cuda::Stream&, const OpacityBatch<float>&, std::int64_t);

}  // namespace chiaro::kernel

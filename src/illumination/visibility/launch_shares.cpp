#include "illumination/visibility/surface_share_kernel.h"
#include "kernel/launch.h"

namespace chiaro::kernel::CHIARO_ISA {

template <class Voxel>
void share_row(const SurfaceShareKernel<Voxel>& kernel, std::int32_t y, std::int32_t z) {
    kernel.template row<NativeLanes>(y, z);
}

template void share_row(const SurfaceShareKernel<std::uint8_t>&, std::int32_t, std::int32_t);
template void share_row(const SurfaceShareKernel<std::uint16_t>&, std::int32_t, std::int32_t);
template void share_row(const SurfaceShareKernel<float>&, std::int32_t, std::int32_t);

}  // namespace chiaro::kernel::CHIARO_ISA

#include "kernel/launch.h"
#include "illumination/reference/kernel.h"

namespace chiaro::kernel::CHIARO_ISA {

template <class Rays>
void trace_column(const RayKernel<Rays>& kernel, const NodeColumn& nodes) {
    run_column<NativeLanes>(kernel, nodes);
}

template void trace_column(const RayKernel<CellRays>&, const NodeColumn&);
template void trace_column(const RayKernel<InterpolatedRays<std::uint8_t>>&, const NodeColumn&);
template void trace_column(const RayKernel<InterpolatedRays<std::uint16_t>>&, const NodeColumn&);
template void trace_column(const RayKernel<InterpolatedRays<float>>&, const NodeColumn&);

}  // namespace chiaro::kernel::CHIARO_ISA

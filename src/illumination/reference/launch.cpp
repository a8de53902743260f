#include "kernel/launch.h"
#include "illumination/reference/harmonics.h"

namespace chiaro::kernel::CHIARO_ISA {

template <class Rays>
void trace_column(const RayKernel<Rays>& kernel, const NodeColumn& nodes) {
    run_column<NativeLanes>(kernel, nodes);
}

template <class Rays>
void trace_runs(const HarmonicsKernel<Rays>& kernel, const NodeRun* runs, std::int32_t count, HarmonicSums* sums) {
    for (std::int32_t i = 0; i < count; ++i) kernel.template operator()<NativeLanes>(runs[i], sums[i]);
}

template void trace_column(const RayKernel<CellRays>&, const NodeColumn&);
template void trace_column(const RayKernel<InterpolatedRays<std::uint8_t>>&, const NodeColumn&);
template void trace_column(const RayKernel<InterpolatedRays<std::uint16_t>>&, const NodeColumn&);
template void trace_column(const RayKernel<InterpolatedRays<float>>&, const NodeColumn&);

template void trace_runs(const HarmonicsKernel<CellRays>&, const NodeRun*, std::int32_t, HarmonicSums*);
template void trace_runs(const HarmonicsKernel<InterpolatedRays<std::uint8_t>>&, const NodeRun*, std::int32_t,
                         HarmonicSums*);
template void trace_runs(const HarmonicsKernel<InterpolatedRays<std::uint16_t>>&, const NodeRun*, std::int32_t,
                         HarmonicSums*);
template void trace_runs(const HarmonicsKernel<InterpolatedRays<float>>&, const NodeRun*, std::int32_t, HarmonicSums*);

}  // namespace chiaro::kernel::CHIARO_ISA

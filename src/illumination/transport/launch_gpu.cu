// Transport on GPUs: the same source, one thread a cell.
#include "cuda/each_node.h"
#include "cuda/launch.h"
#include "illumination/transport/launch_gpu.h"

namespace chiaro::kernel {

template void run_on_gpu(cuda::Stream&, std::int64_t, const FillKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const SweepPlaneKernel<FirstSide>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const SweepPlaneKernel<SourceSide>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const AddUpKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const DominantLightKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const ScatteredNodeKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const StartKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const TurnKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const UpdateCellKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const ChangeKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const FaceKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const ReflectKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const CoverKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const NodeKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const ColourSums<StoredValues<std::uint8_t>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const ColourSums<StoredValues<std::uint16_t>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const ColourSums<StoredValues<float>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const AlbedoKernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const DownsampleBy3Kernel&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<OnSkin<MarkOpaque>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<OnSkin<FindFillOf<std::uint8_t>>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<OnSkin<FindFillOf<std::uint16_t>>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<OnSkin<FindFillOf<float>>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<OnSkin<FindThin>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const EachNode<OnSkin<OpenBoundary>>&);

}  // namespace chiaro::kernel

// Density on GPUs: one thread a cell, or a node.
#include "cuda/launch.h"
#include "illumination/visibility/launch_gpu.h"

namespace chiaro::kernel {

template <class Voxel>
using VoxelTiles = FillTiles<DepthOfVoxels<Voxel, SubVoxelIntegralOfVoxels<Voxel>>>;
template <class Voxel>
using LevelTiles = FillTiles<DepthBetweenVoxels<Voxel, SubVoxelIntegralOfLevels>>;

template void run_on_gpu(cuda::Stream&, std::int64_t, const VoxelTiles<std::uint8_t>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const VoxelTiles<std::uint16_t>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const FillTiles<DepthOfVoxels<float, SubVoxelIntegralOfAny>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const LevelTiles<std::uint8_t>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const LevelTiles<std::uint16_t>&);
template void run_on_gpu(cuda::Stream&, std::int64_t,
                         const FillTiles<DepthBetweenVoxels<float, SubVoxelIntegralOfAny>>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const FillTiles<DepthOfOpacity>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const FillTiles<DepthOfNodes>&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const HalveTiles&);
template void run_on_gpu(cuda::Stream&, std::int64_t, const KeepTiles&);

}  // namespace chiaro::kernel

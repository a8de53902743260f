// Density on cards: one thread a cell, or a node.
#include "cuda/launch.h"
#include "illumination/visibility/launch_card.h"

namespace chiaro::kernel {

template <class Voxel>
using VoxelTiles = FillTiles<DepthOfVoxels<Voxel, HalfWayOfVoxels<Voxel>>>;
template <class Voxel>
using LevelTiles = FillTiles<DepthBetweenVoxels<Voxel, HalfWayOfLevels>>;

template void run_on_card(cuda::Stream&, std::int64_t, const VoxelTiles<std::uint8_t>&);
template void run_on_card(cuda::Stream&, std::int64_t, const VoxelTiles<std::uint16_t>&);
template void run_on_card(cuda::Stream&, std::int64_t, const FillTiles<DepthOfVoxels<float, HalfWayOfAny>>&);
template void run_on_card(cuda::Stream&, std::int64_t, const LevelTiles<std::uint8_t>&);
template void run_on_card(cuda::Stream&, std::int64_t, const LevelTiles<std::uint16_t>&);
template void run_on_card(cuda::Stream&, std::int64_t, const FillTiles<DepthBetweenVoxels<float, HalfWayOfAny>>&);
template void run_on_card(cuda::Stream&, std::int64_t, const FillTiles<DepthOfOpacity>&);
template void run_on_card(cuda::Stream&, std::int64_t, const FillTiles<DepthOfNodes>&);
template void run_on_card(cuda::Stream&, std::int64_t, const HalveTiles&);
template void run_on_card(cuda::Stream&, std::int64_t, const KeepTiles&);

}  // namespace chiaro::kernel

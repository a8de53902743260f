#include "illumination/histogram/gpu_fast.h"

namespace chiaro {
namespace {

/// Of all planes of nodes and some of cells, so that rooms follow each other.
std::size_t workspace_of(kernel::FastBlock& block, int planes, std::byte* memory) {
    return (carve_workspace(block, {kernel::FastBlock::nodes, planes, block_edge, block_edge}, memory) + 255) / 256 *
           256;
}
std::size_t workspace_bytes_of(kernel::FastBlock block, int planes) { return workspace_of(block, planes, nullptr); }

}  // namespace

GpuFastHistograms::GpuFastHistograms(const Device& device, const HistogramData& data, int step, FastShape shape)
    : GpuHistograms(device, data, step, [&](int planes) { return workspace_bytes_of(shape.block, planes); }),
      shape_(std::move(shape)),
      code_(stream_, shape_.code.size()),
      blocks_(stream_, together_),
      workspace_(stream_, together_ * workspace_bytes_of(shape_.block, slab_.planes)),
      normals_(stream_, 3 * cells_together()) {
    std::vector<kernel::FastBlock> blocks(together_, shape_.block);
    const std::size_t bytes = workspace_.size() / together_;
    for (std::size_t i = 0; i < together_; ++i) workspace_of(blocks[i], slab_.planes, workspace_.data() + i * bytes);
    const cuda::SyncOnExit sync{stream_};
    stream_.upload(blocks_.data(), blocks.data(), together_ * sizeof blocks[0]);
    stream_.upload(code_.data(), shape_.code.data(), code_.size() * sizeof shape_.code[0]);
    batch_.blocks = blocks_.data(), batch_.code = code_.data(), batch_.normals = normals_.data();
    batch_.tile_size = shape_.block.tile_size();
}

void GpuFastHistograms::begin(const kernel::HistogramSlab& slab, std::int64_t blocks) {
    workspace_.zero();
    batch_.slab = slab;
    kernel::fast_sums(stream_, batch_, shape_.block, blocks);
}

void GpuFastHistograms::fill(const kernel::HistogramSlab& slab, std::int64_t blocks) {
    batch_.slab = slab;
    kernel::fast_cells(stream_, batch_, blocks);
}

}  // namespace chiaro

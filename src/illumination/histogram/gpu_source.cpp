#include "illumination/histogram/gpu_source.h"

#include "illumination/histogram/gpu_balls.h"
#include "illumination/histogram/gpu_fast.h"

namespace chiaro {
namespace {

using kernel::HistogramSlab;

constexpr std::size_t max_workspace = std::size_t(8) << 30;

}  // namespace

GpuHistograms::GpuHistograms(const Device& device, const HistogramData& data, int step,
                             const std::function<std::size_t(int)>& bytes_of)
    : stream_(*device.stream), slab_{} {
    slab_.grid = data.cells.view_on_gpu(stream_);
    slab_.step = step, slab_.bins = padded_bins(data.packing.packed);
    share_out(std::min(stream_.free_bytes() / 4, max_workspace), [&](int planes) {
        return bytes_of(planes) + std::size_t(planes) * HistogramSlab::plane * 2 * bins() * sizeof(PackedHistogram);
    });
    slab_.histograms = histograms_.emplace(stream_, cells_together() * 2 * std::size_t(bins())).data();
}

/// As many blocks as there is room for, no two above each other; then as many planes.
void GpuHistograms::share_out(std::size_t memory, const std::function<std::size_t(int)>& bytes_of) {
    const std::int32_t* cells = slab_.grid.count;
    const BlockMap blocks({cells[0], cells[1], cells[2]});
    together_ = std::clamp<std::size_t>(memory / bytes_of(1), 1, std::size_t(blocks.count[0]) * blocks.count[1]);
    slab_.planes = block_edge;
    while (slab_.planes > 1 && together_ * bytes_of(slab_.planes) > memory) slab_.planes /= 2;
}

void GpuHistograms::find(const BlockMap& map, std::string_view stage, Progress& progress, const UseSlab& use) {
    HistogramSlab slab = slab_;
    const auto work = [&](const kernel::BlockPlace* places, std::int64_t blocks) {
        slab.places = places;
        begin(slab, blocks);
        for (slab.z = 0; slab.z < block_edge; slab.z += slab.planes) {
            fill(slab, blocks);
            use(slab, blocks);
        }
        slab.first_block += std::int32_t(blocks);
    };
    for_blocks(stream_, map, stage, progress, work, together_);
}

std::unique_ptr<GpuHistograms> make_gpu_histograms(const Device& device, const HistogramData& data, HistogramPath path,
                                                   int step) {
    switch (path) {
        case HistogramPath::sweep:
            return std::make_unique<GpuSweptHistograms>(device, data, step);
        case HistogramPath::exact:
            return std::make_unique<GpuExactHistograms>(device, data, step);
        default:
            return std::make_unique<GpuFastHistograms>(device, data, step);
    }
}

}  // namespace chiaro

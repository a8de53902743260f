// A second order of steps beside source.cpp, which has the same kernels: the CPU makes histograms row by row and uses
// them while they are in its cache, a block for each thread; a GPU makes a slab of many blocks, as much as its memory
// holds.
#include "illumination/histogram/gpu_source.h"

#include "illumination/histogram/fast.h"
#include "illumination/histogram/slab_source.h"
#include "illumination/histogram/sweep.h"

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

namespace {

/// Those of a histogram by brute force: packed bins at once where every bin goes to one.
int places_of(const HistogramData& data) {
    return data.packing.is_one_to_one() ? data.packing.packed : data.cells.binning.count;
}

HostArrays arrays_of(const Ball& ball, const Packing& packing) {
    HostArrays arrays;
    arrays.add(ball.rows), arrays.add(ball.weights);
    arrays.add(packing.low), arrays.add(packing.share);
    return arrays;
}

/// As HistogramPath::exact: room for the places of all cells of a slab, eight numbers each.
class GpuExactHistograms : public GpuHistograms {
public:
    GpuExactHistograms(const Device& device, const HistogramData& data, int step);

private:
    void fill(const kernel::HistogramSlab& slab, std::int64_t blocks) override;

    const Ball ball_;
    const cuda::Array<std::uint16_t> places_;
    cuda::Array<float> counts_;
    const cuda::Array<float> packed_;
    cuda::Views views_;
    kernel::CountSlab count_{};
    kernel::PackSlab pack_{};
};

/// As SweptHistograms.
class GpuSweptHistograms : public GpuHistograms {
public:
    GpuSweptHistograms(const Device& device, const HistogramData& data, int step);

private:
    void fill(const kernel::HistogramSlab& slab, std::int64_t blocks) override;

    const Ball ball_;
    const cuda::Array<std::int32_t> counts_;
    cuda::Views views_;
    kernel::SweepSlab sweep_{};
};

GpuExactHistograms::GpuExactHistograms(const Device& device, const HistogramData& data, int step)
    : GpuHistograms(device, data, step,
                    [&](int planes) {
                        const int numbers = 2 * (4 * places_of(data) + padded_bins(data.packing.packed));
                        return std::size_t(planes) * HistogramSlab::plane * std::size_t(numbers) * sizeof(float);
                    }),
      ball_(data.radius, true),
      places_(stream_, data.packing.is_one_to_one() ? data.cells.grid.size() : 1),
      counts_(stream_, cells_together() * 8 * std::size_t(places_of(data))),
      packed_(stream_, cells_together() * 2 * std::size_t(bins())),
      views_(stream_, arrays_of(ball_, data.packing)) {
    count_.ball = ball_.view(), pack_.packing = data.packing.view();
    views_.to_device_pointers(count_.ball.row, count_.ball.weights, pack_.packing.low, pack_.packing.share);
    count_.places = slab_.grid.bins;
    count_.count = pack_.count = places_of(data);
    count_.counts = counts_.data(), pack_.counts = counts_.data(), pack_.packed = packed_.data();
    if (!data.packing.is_one_to_one()) return;
    kernel::run_on_gpu(stream_, std::int64_t(places_.size()),
                       kernel::PlaceCells{slab_.grid.bins, pack_.packing.low, places_.data()});
    count_.places = places_.data(), pack_.packing = {};
}

void GpuExactHistograms::fill(const HistogramSlab& slab, std::int64_t blocks) {
    count_.slab = pack_.slab = slab;
    counts_.zero();
    kernel::run_on_gpu(stream_, blocks * slab.cells() * 2, count_);
    kernel::run_on_gpu(stream_, blocks * slab.cells() * 2, pack_);
}

GpuSweptHistograms::GpuSweptHistograms(const Device& device, const HistogramData& data, int step)
    : GpuHistograms(device, data, step,
                    [&](int planes) {
                        const std::size_t rows = std::size_t(planes) * HistogramSlab::edge;
                        return rows * std::size_t(padded_bins(data.packing.packed)) * sizeof(std::int32_t);
                    }),
      ball_(data.radius, false),
      counts_(stream_, cells_together() / HistogramSlab::edge * std::size_t(bins())),
      views_(stream_, arrays_of(ball_, data.packing)) {
    sweep_.row = swept_row(slab_.grid, data.packing, ball_);
    views_.to_device_pointers(sweep_.row.ball.row, sweep_.row.ball.weights, sweep_.row.packing.low,
                              sweep_.row.packing.share);
    sweep_.counts = counts_.data();
}

void GpuSweptHistograms::fill(const HistogramSlab& slab, std::int64_t blocks) {
    sweep_.slab = slab;
    kernel::run_on_gpu(stream_, blocks * slab.cells() / HistogramSlab::edge, sweep_);
}

/// Of all planes of nodes and some of cells, so that rooms follow each other.
std::size_t workspace_of(kernel::FastBlock& block, int planes, std::byte* memory) {
    return (carve_workspace(block, {kernel::FastBlock::nodes, planes, block_edge, block_edge}, memory) + 255) / 256 *
           256;
}
std::size_t workspace_bytes_of(kernel::FastBlock block, int planes) { return workspace_of(block, planes, nullptr); }

/// As FastHistograms.
class GpuFastHistograms : public GpuHistograms {
public:
    GpuFastHistograms(const Device& device, const HistogramData& data, int step)
        : GpuFastHistograms(device, data, step, FastShape(data.packing, data.radius)) {}

private:
    GpuFastHistograms(const Device& device, const HistogramData& data, int step, FastShape shape);
    void begin(const kernel::HistogramSlab& slab, std::int64_t blocks) override;
    void fill(const kernel::HistogramSlab& slab, std::int64_t blocks) override;

    const FastShape shape_;
    const cuda::Array<std::uint32_t> code_;
    const cuda::Array<kernel::FastBlock> blocks_;
    cuda::Array<std::byte> workspace_;
    const cuda::Array<float> normals_;
    kernel::FastBatch batch_{};
};

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

}  // namespace

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

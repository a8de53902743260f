#include "illumination/histogram/histograms.h"

#include <numeric>

#include "cuda/executor.h"
#include "illumination/histogram/exact.h"
#include "illumination/histogram/fast.h"
#include "illumination/histogram/gpu.h"
#include "illumination/histogram/launch.h"
#include "illumination/histogram/members.h"
#include "illumination/histogram/normal_offset_kernel.h"
#include "illumination/histogram/source.h"
#include "illumination/histogram/training_set.h"

namespace chiaro {
namespace {

/// Identifiers of every node: histograms come a row at a time, and go.
void assign(const Device& device, const HistogramData& data, HistogramPath path, const Codebook& codebook,
            LocalHistograms& out, Progress& progress) {
    const CellGrid& grid = data.cells.grid;
    const auto source = make_source(device, data, path);
    const auto kernels = kernel::histogram_functions_for(device.isa);
    const BlockMap blocks(grid.count);
    parallel_for(device.threads, std::int64_t(blocks.holds.size()), 1, "histograms", progress,
                 [&](std::int64_t b, std::int64_t) {
                     const auto [x, y, z] = blocks.cells(std::size_t(b), grid.count);
                     const int step = out.subsample, count = (x.second - x.first + step - 1) / step;
                     CodewordPair guess{0, 0};
                     const auto row = [&, x = x.first / step, y0 = y.first, z0 = z.first](
                                          int j, int k, const PackedHistogram* histograms) {
                         progress.check();  // a block takes a while
                         const std::size_t at =
                             (std::size_t(k / step) * out.nodes[1] + std::size_t(j / step)) * out.nodes[0] + x;
                         CodewordPair* to = out.pairs().data() + at;
                         *to = guess;
                         const std::ptrdiff_t width = out.nodes[0], slice = width * out.nodes[1];
                         const std::uint16_t *above = j > y0 ? &(to - width)->forward : nullptr,
                                             *behind = k > z0 ? &(to - slice)->forward : nullptr;
                         kernels.assign_row(codebook.view(), histograms, count, above, behind, &to->forward);
                         guess = *to;
                     };
                     source->find(
                         std::size_t(b), step, [](int, int) { return true; }, row);
                 });
    progress.check();
}

/// How many cells are in each bin need not be known for bins of equal width.
Packing packing_of(const BinnedCells& cells, const HistogramSettings& settings) {
    const bool needs_counts = settings.packing != HistogramPacking::uniform;
    const std::vector<std::uint64_t> none(std::size_t(cells.binning.count));
    return make_packing(settings.packing, settings.packed_bins, needs_counts ? cells.counts() : none);
}

}  // namespace

LocalHistograms find_local_histograms(const Device& device, const DeviceVolume::Data& volume,
                                      const HistogramSettings& settings, StageTimer& timer, Progress& progress) {
    HistogramData data{
        timer("histogram bins", [&] { return bin_cells(device, volume, progress); }), {}, settings.radius};
    const CellGrid& grid = data.cells.grid;
    data.packing = packing_of(data.cells, settings);
    const int bins = padded_bins(data.packing.packed);

    const auto vectors = timer("histogram samples", [&] {
        return sample_histograms(device, data, settings.path, 32 * settings.clusters, progress);
    });
    Training training{settings.clusters, settings.metric, 1e-3, {}};
    const Codebook codebook =
        timer("histogram training", [&] { return train_codebook(device, vectors, bins, training, progress); });

    LocalHistograms out;
    out.grid = grid, out.binning = data.cells.binning, out.radius = settings.radius, out.subsample = settings.subsample;
    for (int axis = 0; axis < 3; ++axis) out.nodes[axis] = (grid.count[axis] - 1) / out.subsample + 1;
    out.identifiers = VoxelBuffer((out.node_count() + 1) * sizeof(CodewordPair));
    out.codewords = codebook.count(), out.histograms = 2 * out.node_count(), out.distortions = training.distortions;
    timer("histograms", [&] {
        const auto on_gpu = [&] { assign_on_gpu(device, data, settings.path, codebook, out, progress); };
        if (!cuda::try_gpu(device, on_gpu)) assign(device, data, settings.path, codebook, out, progress);
    });
    timer("histogram words", [&] {
        const Ball ball(settings.radius, settings.path != HistogramPath::sweep);
        find_codewords(device, data.cells, ball, settings.path == HistogramPath::sweep, out, progress);
    });
    timer("histogram lift", [&] { normal_offset_identifiers(device, data.cells, out); });
    return out;
}

namespace {

kernel::BinGrid view_in(const CpuExecutor&, const BinnedCells& cells) { return cells.view(); }
kernel::BinGrid view_in(const GpuExecutor& executor, const BinnedCells& cells) {
    return cells.view_on_gpu(executor.stream());
}

}  // namespace

void normal_offset_identifiers(const Device& device, const BinnedCells& cells, LocalHistograms& h) {
    h.displaced = MirroredBuffer(h.identifiers.size());
    const auto [nx, ny, nz] = h.nodes;
    run_steps(device, nullptr, [&, nx = nx, ny = ny, nz = nz](auto& executor) {
        const auto made = executor.template output<std::uint16_t>(h.displaced);
        const kernel::NormalOffsetKernel normal_offset{
            view_in(executor, cells),
            reinterpret_cast<const std::uint16_t*>(executor.kept(h.life, h.identifiers)),
            made.data(),
            {nx, ny, nz},
            h.subsample};
        executor.for_each_node(h.nodes, normal_offset, {}, 1);
        made.keep();
    });
}

}  // namespace chiaro

#include "illumination/histogram/histograms.h"

#include <numeric>

#include "cuda/executor.h"
#include "illumination/histogram/card.h"
#include "illumination/histogram/exact.h"
#include "illumination/histogram/fast.h"
#include "illumination/histogram/launch.h"
#include "illumination/histogram/lift_kernel.h"
#include "illumination/histogram/members.h"
#include "illumination/histogram/source.h"
#include "illumination/histogram/training_set.h"

namespace chiaro {
namespace {

/// Identifiers of every node: histograms come a row at a time, and go.
void assign(const Device& device, const HistogramData& data, HistogramPath path, const Codebook& book,
            LocalHistograms& out, Progress& progress) {
    const CellGrid& grid = data.cells.grid;
    const auto source = make_source(device, data, path);
    const auto kernels = kernel::histogram_functions_for(device.isa);
    const BlockMap blocks(grid.count);
    parallel_for(device.threads, std::int64_t(blocks.holds.size()), 1, "histograms", progress,
                 [&](std::int64_t b, std::int64_t) {
                     const auto [x, y, z] = blocks.cells(std::size_t(b), grid.count);
                     const int step = out.subsample, count = (x.second - x.first + step - 1) / step;
                     WordPair guess{0, 0};
                     const auto row = [&, x = x.first / step](int j, int k, const PackedHistogram* histograms) {
                         const std::size_t at =
                             (std::size_t(k / step) * out.nodes[1] + std::size_t(j / step)) * out.nodes[0] + x;
                         WordPair* to = out.pairs().data() + at;
                         *to = guess;
                         kernels.assign_row(book.view(), histograms, count, &to->forward);
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
                                      const HistogramSettings& settings, Steps& steps, Progress& progress) {
    HistogramData data{
        steps("histogram bins", [&] { return bin_cells(device, volume, progress); }), {}, settings.radius};
    const CellGrid& grid = data.cells.grid;
    data.packing = packing_of(data.cells, settings);
    const int bins = padded_bins(data.packing.packed);

    const auto vectors = steps("histogram samples", [&] {
        return sample_histograms(device, data, settings.path, 32 * settings.clusters, progress);
    });
    Training training{settings.clusters, settings.metric, 1e-3, {}};
    const Codebook book =
        steps("histogram training", [&] { return train_codebook(device, vectors, bins, training, progress); });

    LocalHistograms out;
    out.grid = grid, out.binning = data.cells.binning, out.radius = settings.radius, out.subsample = settings.subsample;
    for (int axis = 0; axis < 3; ++axis) out.nodes[axis] = (grid.count[axis] - 1) / out.subsample + 1;
    out.identifiers = VoxelBuffer((out.node_count() + 1) * sizeof(WordPair));
    out.words = book.count(), out.histograms = 2 * out.node_count(), out.distortions = training.distortions;
    steps("histograms", [&] {
        const auto on_card = [&] { assign_on_card(device, data, settings.path, book, out, progress); };
        if (!cuda::done_on_card(device, on_card)) assign(device, data, settings.path, book, out, progress);
    });
    steps("histogram words", [&] {
        const Ball ball(settings.radius, settings.path != HistogramPath::sweep);
        find_words(device, data.cells, ball, settings.path == HistogramPath::sweep, out, progress);
    });
    steps("histogram lift", [&] { lift_identifiers(device, data.cells, out); });
    return out;
}

namespace {

kernel::BinGrid view_in(const CpuExecutor&, const BinnedCells& cells) { return cells.view(); }
kernel::BinGrid view_in(const GpuExecutor& executor, const BinnedCells& cells) {
    return cells.view_on_card(executor.stream());
}

}  // namespace

void lift_identifiers(const Device& device, const BinnedCells& cells, LocalHistograms& h) {
    h.lifted = TwinBuffer(h.identifiers.size());
    const auto [nx, ny, nz] = h.nodes;
    run_steps(device, nullptr, [&, nx = nx, ny = ny, nz = nz](auto& executor) {
        const auto made = executor.template output<std::uint16_t>(h.lifted);
        const kernel::LiftKernel lift{view_in(executor, cells),
                                      reinterpret_cast<const std::uint16_t*>(executor.kept(h.life, h.identifiers)),
                                      made.data(),
                                      {nx, ny, nz},
                                      h.subsample};
        executor.for_each_node(h.nodes, lift, {}, 1);
        made.keep();
    });
}

}  // namespace chiaro

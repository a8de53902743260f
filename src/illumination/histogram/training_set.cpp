#include "illumination/histogram/training_set.h"

#include <algorithm>
#include <numeric>

#include "core/threads.h"
#include "illumination/histogram/gpu.h"

namespace chiaro {
namespace {

using Range = std::array<std::pair<int, int>, 3>;

template <class Visit>
void for_cells(const Range& range, Visit&& visit) {
    const auto& [x, y, z] = range;
    for (int k = z.first; k < z.second; ++k)
        for (int j = y.first; j < y.second; ++j)
            for (int i = x.first; i < x.second; ++i) visit(i, j, k);
}

/// Of a block, one byte for each cell: whether it is chosen.
struct Chosen {
    std::size_t block;
    Range range;
    std::vector<std::uint8_t> cells;

    std::size_t width() const { return std::size_t(range[0].second - range[0].first); }
    const std::uint8_t* row(int y, int z) const {
        const auto height = std::size_t(range[1].second - range[1].first);
        return cells.data() + (std::size_t(z - range[2].first) * height + std::size_t(y - range[1].first)) * width();
    }
};

void choose(const BinnedCells& cells, double wanted, Chosen& to) {
    const kernel::EdgeTest is_at_edge = edge_test(cells.view(), cells.binning);
    std::vector<std::uint8_t> edge;
    for_cells(to.range, [&](int i, int j, int k) { edge.push_back(is_at_edge(i, j, k)); });
    const auto shares =
        kernel::ChoiceShares::of(wanted, double(edge.size()), std::accumulate(edge.begin(), edge.end(), 0));
    for_cells(to.range, [&](int i, int j, int k) {
        to.cells.push_back(shares.takes(cells.grid.index(i, j, k), edge[to.cells.size()] != 0));
    });
}

/// Some of the blocks, in order.
std::vector<std::size_t> some_blocks(std::size_t all) {
    std::vector<std::size_t> blocks(all);
    std::iota(blocks.begin(), blocks.end(), std::size_t(0));
    std::sort(blocks.begin(), blocks.end(), [](std::size_t a, std::size_t b) { return mixed(a) < mixed(b); });
    blocks.resize(std::min(all, std::max<std::size_t>(all / 4, 64)));
    std::sort(blocks.begin(), blocks.end());
    return blocks;
}

/// Both histograms of all that are chosen, block after block.
std::vector<PackedHistogram> found_here(const Device& device, const HistogramData& data, HistogramPath path,
                                        const std::vector<std::size_t>& blocks, double wanted_cells,
                                        Progress& progress) {
    const auto source = make_source(device, data, path);
    const auto bins = std::size_t(source->bins());
    const auto& count = data.cells.grid.count;
    std::vector<std::vector<PackedHistogram>> found(blocks.size());
    const auto work = [&](std::int64_t b, std::int64_t) {
        Chosen its{blocks[std::size_t(b)], BlockMap(count).cells(blocks[std::size_t(b)], count), {}};
        choose(data.cells, wanted_cells, its);
        auto& to = found[std::size_t(b)];
        const auto wanted = [&](int j, int k) {
            progress.check();  // a block takes a while
            return std::any_of(its.row(j, k), its.row(j, k) + its.width(), [](auto c) { return c != 0; });
        };
        source->find(its.block, 1, wanted, [&](int j, int k, const PackedHistogram* h) {
            for (std::size_t i = 0; i < its.width(); ++i)
                if (its.row(j, k)[i]) to.insert(to.end(), h + 2 * i * bins, h + 2 * (i + 1) * bins);
        });
    };
    parallel_for(device.threads, std::int64_t(blocks.size()), 1, "histogram samples", progress, work);
    progress.check();
    std::vector<PackedHistogram> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace

PackedHistograms sample_histograms(const Device& device, const HistogramData& data, HistogramPath path,
                                   int cells_wanted, Progress& progress) {
    BlockMap map(data.cells.grid.count);
    const std::vector<std::size_t> blocks = some_blocks(map.holds.size());
    for (const std::size_t block : blocks) map.holds[block] = 1;
    const double wanted = double(cells_wanted) / double(blocks.size());
    PackedHistograms found(0);
    if (!cuda::try_gpu(device, [&] { found = sample_on_gpu(device, data, path, map, wanted, progress); }))
        found = found_here(device, data, path, blocks, wanted, progress);
    if (found.size() > 0) return found;
    return std::vector<PackedHistogram>(std::size_t(padded_bins(data.packing.packed)));  // nothing to tell apart
}

}  // namespace chiaro

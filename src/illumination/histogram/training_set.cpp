#include "illumination/histogram/training_set.h"

#include <algorithm>
#include <numeric>

#include "core/threads.h"
#include "illumination/histogram/card.h"
#include "illumination/histogram/random.h"

namespace chiaro {
namespace {

using Range = std::array<std::pair<int, int>, 3>;

bool is_at_edge(const BinnedCells& cells, int x, int y, int z) {
    const auto g = cells.gradient(x, y, z);
    const float least = std::max(1.0f, float(cells.binning.count) / 200);
    return g[0] * g[0] + g[1] * g[1] + g[2] * g[2] > least * least;
}

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

/// Half of the choice falls on edges, where histograms differ most and light shows; half on all cells, which words must
/// serve too.
void choose(const BinnedCells& cells, double wanted, Chosen& to) {
    std::vector<std::uint8_t> edge;
    for_cells(to.range, [&](int i, int j, int k) { edge.push_back(is_at_edge(cells, i, j, k)); });
    const auto edges = double(std::accumulate(edge.begin(), edge.end(), 0));
    const double all = wanted / 2 / double(edge.size()), at_edges = edges > 0 ? wanted / 2 / edges : 0;
    for_cells(to.range, [&](int i, int j, int k) {
        const double share = random_share(cells.grid.index(i, j, k));
        to.cells.push_back(share < all + (edge[to.cells.size()] ? at_edges : 0));
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
                                        const std::vector<Chosen>& chosen, Progress& progress) {
    const auto source = make_source(device, data, path);
    const auto bins = std::size_t(source->bins());
    std::vector<std::vector<PackedHistogram>> found(chosen.size());
    const auto work = [&](std::int64_t b, std::int64_t) {
        const Chosen& its = chosen[std::size_t(b)];
        auto& to = found[std::size_t(b)];
        const auto wanted = [&](int j, int k) {
            return std::any_of(its.row(j, k), its.row(j, k) + its.width(), [](auto c) { return c != 0; });
        };
        source->find(its.block, 1, wanted, [&](int j, int k, const PackedHistogram* h) {
            for (std::size_t i = 0; i < its.width(); ++i)
                if (its.row(j, k)[i]) to.insert(to.end(), h + 2 * i * bins, h + 2 * (i + 1) * bins);
        });
    };
    parallel_for(device.threads, std::int64_t(chosen.size()), 1, "histogram samples", progress, work);
    progress.check();
    std::vector<PackedHistogram> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

/// The same, in the same order.
std::vector<PackedHistogram> found_on_card(const Device& device, const HistogramData& data, HistogramPath path,
                                           const std::vector<Chosen>& chosen, Progress& progress) {
    using kernel::BlockPlace;
    BlockMap blocks(data.cells.grid.count);
    std::vector<std::int32_t> place(chosen.size() * BlockPlace::cells, -1);
    std::int32_t cells = 0;
    for (std::size_t b = 0; b < chosen.size(); ++b) {
        const auto& [x, y, z] = chosen[b].range;
        blocks.holds[chosen[b].block] = 1;
        for_cells(chosen[b].range, [&, x = x.first, y = y.first, z = z.first, b](int i, int j, int k) {
            if (chosen[b].row(j, k)[i - x])
                place[b * BlockPlace::cells +
                      std::size_t(((k - z) * BlockPlace::edge + j - y) * BlockPlace::edge + i - x)] = cells++;
        });
    }
    if (cells == 0) return {};
    return sample_on_card(device, data, path, blocks, place, std::size_t(cells), progress);
}

}  // namespace

std::vector<PackedHistogram> sample_histograms(const Device& device, const HistogramData& data, HistogramPath path,
                                               int cells_wanted, Progress& progress) {
    const auto& count = data.cells.grid.count;
    std::vector<Chosen> chosen;
    for (const std::size_t block : some_blocks(BlockMap(count).holds.size()))
        chosen.push_back({block, BlockMap(count).cells(block, count), {}});
    parallel_for(device.threads, std::int64_t(chosen.size()), 1, [&](std::int64_t b, std::int64_t) {
        choose(data.cells, double(cells_wanted) / double(chosen.size()), chosen[std::size_t(b)]);
    });
    std::vector<PackedHistogram> all;
    if (!cuda::done_on_card(device, [&] { all = found_on_card(device, data, path, chosen, progress); }))
        all = found_here(device, data, path, chosen, progress);
    if (all.empty())
        all.assign(std::size_t(padded_bins(data.packing.packed)), 0);  // a volume that has nothing to tell apart
    return all;
}

}  // namespace chiaro

#include "illumination/histogram/training_set.h"

#include <algorithm>
#include <numeric>

#include "core/threads.h"
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

/// One byte for each cell of a block: whether it is chosen. Half of the choice falls on edges, where histograms differ
/// most and light shows; half on all cells, which words must serve too.
std::vector<std::uint8_t> choose(const BinnedCells& cells, const Range& range, double wanted) {
    std::vector<std::uint8_t> edge;
    for_cells(range, [&](int i, int j, int k) { edge.push_back(is_at_edge(cells, i, j, k)); });
    const auto edges = double(std::accumulate(edge.begin(), edge.end(), 0));
    const double all = wanted / 2 / double(edge.size()), at_edges = edges > 0 ? wanted / 2 / edges : 0;
    std::vector<std::uint8_t> chosen;
    for_cells(range, [&](int i, int j, int k) {
        const double share = random_share(cells.grid.index(i, j, k));
        chosen.push_back(share < all + (edge[chosen.size()] ? at_edges : 0));
    });
    return chosen;
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

}  // namespace

std::vector<PackedHistogram> sample_histograms(const Device& device, const HistogramSource& source,
                                               const BinnedCells& cells, int cells_wanted, Progress& progress) {
    const BlockMap map(cells.grid.count);
    const auto blocks = some_blocks(map.holds.size());
    const auto bins = std::size_t(source.bins());
    std::vector<std::vector<PackedHistogram>> found(blocks.size());
    parallel_for(
        device.threads, std::int64_t(blocks.size()), 1, "histogram samples", progress,
        [&](std::int64_t b, std::int64_t) {
            auto& to = found[std::size_t(b)];
            const Range range = map.cells(blocks[std::size_t(b)], cells.grid.count);
            const auto chosen = choose(cells, range, double(cells_wanted) / double(blocks.size()));
            const auto [x, y, z] = range;
            const std::size_t width = std::size_t(x.second - x.first);
            const auto row = [&, y = y, z = z](int j, int k) {
                return chosen.begin() + std::ptrdiff_t((std::size_t(k - z.first) * std::size_t(y.second - y.first) +
                                                        std::size_t(j - y.first)) *
                                                       width);
            };
            const auto wanted = [&](int j, int k) {
                return std::any_of(row(j, k), row(j, k) + std::ptrdiff_t(width), [](auto c) { return c != 0; });
            };
            source.find(blocks[std::size_t(b)], 1, wanted, [&](int j, int k, const PackedHistogram* h) {
                for (std::size_t i = 0; i < width; ++i)
                    if (row(j, k)[std::ptrdiff_t(i)]) to.insert(to.end(), h + 2 * i * bins, h + 2 * (i + 1) * bins);
            });
        });
    progress.check();
    std::vector<PackedHistogram> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    if (all.empty()) all.assign(bins, 0);  // a volume that has nothing to tell apart
    return all;
}

}  // namespace chiaro

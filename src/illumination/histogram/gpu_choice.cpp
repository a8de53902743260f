#include <numeric>

#include "illumination/histogram/gpu.h"
#include "illumination/histogram/training_set.h"

namespace chiaro {
namespace {

using kernel::BlockRows;
using Counts = std::vector<std::int32_t>;

/// Which cells of some blocks are chosen, row by row.
class GpuChoice {
public:
    GpuChoice(cuda::Stream& stream, const BinnedCells& cells, const BlockMap& blocks)
        : stream_(stream),
          blocks_(places_of(blocks)),
          rows_(blocks_.size() * BlockRows::of_block),
          there_(stream, blocks_.size()),
          shares_(stream, blocks_.size()),
          first_(stream, rows_),
          place_(stream, blocks_.size() * kernel::BlockPlace::cells),
          look_{edge_test(cells.view_on_gpu(stream), cells.binning), there_.data()} {
        stream.upload(there_.data(), blocks_.data(), blocks_.size() * sizeof blocks_[0]);
    }

    /// About so many of each block; returns how many they are.
    std::size_t choose(double wanted) {
        const std::vector<kernel::ChoiceShares> shares =
            shares_of(counted(kernel::CountEdges{look_, first_.data()}), wanted);
        const cuda::SyncOnExit shares_are_there{stream_};
        stream_.upload(shares_.data(), shares.data(), shares.size() * sizeof shares[0]);
        const kernel::ChooseRow row{look_, shares_.data()};
        Counts first = counted(kernel::CountChosen{row, first_.data()});
        const std::int32_t last = first.back();
        std::exclusive_scan(first.begin(), first.end(), first.begin(), 0);
        const cuda::SyncOnExit sync{stream_};
        stream_.upload(first_.data(), first.data(), first.size() * sizeof first[0]);
        place_.zero();
        kernel::run_on_gpu(stream_, std::int64_t(rows_), kernel::PlaceChosen{row, first_.data(), place_.data()});
        stream_.wait();
        return std::size_t(first.back() + last);
    }
    const std::int32_t* places() const { return place_.data(); }

private:
    template <class Kernel>
    Counts counted(const Kernel& count) const {
        Counts counts(rows_);
        kernel::run_on_gpu(stream_, std::int64_t(rows_), count);
        stream_.download(counts.data(), count.counts, rows_ * sizeof counts[0]);
        stream_.wait();
        return counts;
    }
    std::vector<kernel::ChoiceShares> shares_of(const Counts& edges, double wanted) const {
        std::vector<kernel::ChoiceShares> shares;
        for (auto row = edges.begin(); const kernel::BlockPlace& block : blocks_) {
            double cells = 1;
            for (int axis = 0; axis < 3; ++axis)
                cells *= std::min(look_.is_at_edge.grid.count[axis] - block.first[axis], block_edge);
            shares.push_back(
                kernel::ChoiceShares::of(wanted, cells, std::accumulate(row, row + BlockRows::of_block, 0)));
            row += BlockRows::of_block;
        }
        return shares;
    }

    cuda::Stream& stream_;
    const std::vector<kernel::BlockPlace> blocks_;
    const cuda::SyncOnExit sync_{stream_};  ///< before the blocks go
    const std::size_t rows_;
    const cuda::Array<kernel::BlockPlace> there_;
    const cuda::Array<kernel::ChoiceShares> shares_;
    const cuda::Array<std::int32_t> first_;  ///< counts of rows, then sums
    cuda::Array<std::int32_t> place_;
    const BlockRows look_;
};

}  // namespace

PackedHistograms sample_on_gpu(const Device& device, const HistogramData& data, HistogramPath path,
                               const BlockMap& blocks, double wanted, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    GpuChoice choice(stream, data.cells, blocks);
    const std::size_t cells = choice.choose(wanted);
    if (cells == 0) return PackedHistograms(0);
    const auto histograms = make_gpu_histograms(device, data, path, 1);
    const cuda::Array<PackedHistogram> list(stream, 2 * cells * std::size_t(histograms->bins()));
    const auto take = [&](const kernel::HistogramSlab& slab, std::int64_t count) {
        kernel::run_on_gpu(stream, count * slab.cells(), kernel::TakeFromSlab{slab, choice.places(), list.data()});
    };
    histograms->find(blocks, "histogram samples", progress, take);
    PackedHistograms found(list.size());
    found.buffer.keep(device.stream, list.data());
    return found;
}

}  // namespace chiaro

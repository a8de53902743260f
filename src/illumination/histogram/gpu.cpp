#include "illumination/histogram/gpu.h"

#include <numeric>

#include "core/threads.h"
#include "illumination/histogram/gpu_vectors.h"
#include "illumination/histogram/training_set.h"

namespace chiaro {

void assign_on_gpu(const Device& device, const HistogramData& data, HistogramPath path, const Codebook& codebook,
                   LocalHistograms& out, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const auto histograms = make_gpu_histograms(device, data, path, out.subsample);
    GpuUnresolved unresolved(stream, 2 * histograms->cells_together());
    cuda::Array<std::byte> codewords(stream, out.identifiers.size());
    codewords.zero();
    kernel::AssignSlab assign{.slab = {},
                              .codebook = codebook.view_on_gpu(stream),
                              .codewords = reinterpret_cast<std::uint16_t*>(codewords.data()),
                              .nodes = {out.nodes[0], out.nodes[1], out.nodes[2]}};
    histograms->find(BlockMap(data.cells.grid.count, true), "histograms", progress,
                     [&](const kernel::HistogramSlab& slab, std::int64_t blocks) {
                         assign.slab = slab;
                         kernel::assign_slab(stream, assign, unresolved.none(), blocks);
                     });
    stream.download(out.identifiers.data(), codewords.data(), codewords.size());
    stream.wait();
    try {
        stream.device_cache()->keep(HostArray::of(out.life, out.identifiers), codewords.data(), stream);
    } catch (const cuda::OutOfMemory&) {
    }  // they are here too, and are sent when they are needed
}

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

namespace {

constexpr std::size_t max_counts = std::size_t(1) << 28;

/// Words whose members' counts are in memory at the same time.
class GpuCodewords {
public:
    GpuCodewords(cuda::Stream& stream, const CodewordMembers& taken, int bins, std::size_t max_codewords)
        : stream_(stream),
          taken_(taken),
          bins_(std::size_t(bins)),
          members_(stream, max_codewords * max_members),
          begin_(stream, max_codewords + 1),
          counts_(stream, members_.size() * 4 * bins_),
          sums_(stream, max_codewords * bins_),
          histograms_(sums_.size()) {}

    /// The sums of the members of words [first, end), one after the other; until called again.
    const float* sums(std::size_t first, std::size_t end, kernel::CountMembers count) {
        const std::int32_t* begin = taken_.begin.data() + first;
        const auto members = std::size_t(taken_.begin[end] - *begin);
        stream_.upload(begin_.data(), begin, (end - first + 1) * sizeof *begin);
        stream_.upload(members_.data(), taken_.members.data() + *begin, members * sizeof taken_.members[0]);
        counts_.zero();
        count.members = members_.data(), count.counts = counts_.data();
        kernel::count_members(stream_, count, std::int64_t(members));
        kernel::add_up_members(stream_, {members_.data(), begin_.data(), int(bins_), counts_.data(), sums_.data()},
                               std::int64_t(end - first));
        stream_.download(histograms_.data(), sums_.data(), (end - first) * bins_ * sizeof(float));
        stream_.wait();
        return histograms_.data();
    }

private:
    cuda::Stream& stream_;
    const CodewordMembers& taken_;
    const std::size_t bins_;
    const cuda::Array<kernel::CodewordMember> members_;
    const cuda::Array<std::int32_t> begin_;
    cuda::Array<float> counts_;
    const cuda::Array<float> sums_;
    std::vector<float> histograms_;
};

}  // namespace

void find_codewords_on_gpu(const Device& device, const BinnedCells& cells, const Ball& ball,
                           const CodewordMembers& taken, LocalHistograms& h, Progress& progress) {
    cuda::Stream& stream = *device.stream;
    const int bins = cells.binning.count;
    HostArrays arrays;
    arrays.add(ball.rows);
    arrays.add(ball.weights);
    cuda::Views views(stream, std::move(arrays));
    kernel::CountMembers count{
        .ball = ball.view(), .cells = cells.view_on_gpu(stream), .members = nullptr, .bins = bins, .counts = nullptr};
    views.to_device_pointers(count.ball.row, count.ball.weights);
    const std::size_t codewords = std::size_t(h.codewords),
                      together =
                          std::clamp<std::size_t>(max_counts / (4 * max_members * std::size_t(bins)), 1, codewords);
    GpuCodewords gpu(stream, taken, bins, together);
    for (std::size_t first = 0; first < codewords; first += together) {
        const std::size_t end = std::min(first + together, codewords);
        const float* sums = gpu.sums(first, end, count);
        parallel_for(device.threads, std::int64_t(end - first), 32, [&](std::int64_t i, std::int64_t last) {
            for (; i < last; ++i) {
                const std::size_t codeword = first + std::size_t(i);
                store_codeword({sums + i * bins, std::size_t(bins)}, int(taken.of(codeword).size()), codeword, h);
            }
        });
        progress.report("histogram words", double(end) / double(codewords));
        progress.check();
    }
}

}  // namespace chiaro

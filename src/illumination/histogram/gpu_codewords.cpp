#include "core/threads.h"
#include "illumination/histogram/gpu.h"

namespace chiaro {
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

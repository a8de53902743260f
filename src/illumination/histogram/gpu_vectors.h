// The histograms of a training set on a GPU, which keeps them from one step of training to the next.
#pragma once
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/launch_gpu.h"

namespace chiaro {

/// Room for histograms that are left over.
class GpuUnresolved {
public:
    GpuUnresolved(cuda::Stream& stream, std::size_t most) : count_(stream, 1), which_(stream, most) {}
    /// None yet.
    kernel::Unresolved none() {
        count_.zero();
        return {count_.data(), which_.data()};
    }

private:
    cuda::Array<cuda::Count> count_;
    const cuda::Array<std::uint32_t> which_;
};

class GpuVectors {
public:
    GpuVectors(const Device& device, const PackedHistograms& vectors, int bins);

    /// The nearest word of each, and how far it is; `words` holds guesses.
    void assign(const Codebook& codebook, std::vector<std::uint16_t>& codewords,
                std::vector<std::int32_t>& differences) const;
    /// Some of them, which come.
    void pick(const std::vector<std::uint32_t>& which, std::vector<PackedHistogram>& found) const;
    /// Adds up the histograms of each word.
    void add_up(const std::vector<std::uint16_t>& codewords, std::vector<std::int64_t>& sums) const;

private:
    kernel::CodewordedVectors view() const;

    std::shared_ptr<cuda::Stream> stream_;
    int bins_;
    const PackedHistogram* vectors_;
    cuda::Array<std::uint16_t> codewords_;
    cuda::Array<std::int32_t> differences_;
    mutable GpuUnresolved unresolved_;
};

}  // namespace chiaro

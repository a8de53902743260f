// The histograms of a training set on a card, which keeps them from one step of training to the next.
#pragma once
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/launch_card.h"

namespace chiaro {

/// Room for histograms that are left over.
class CardLeftOver {
public:
    CardLeftOver(cuda::Stream& stream, std::size_t most) : count_(stream, 1), which_(stream, most) {}
    /// None yet.
    kernel::LeftOver none() {
        count_.zero();
        return {count_.data(), which_.data()};
    }

private:
    cuda::Array<cuda::Count> count_;
    const cuda::Array<std::uint32_t> which_;
};

class CardVectors {
public:
    CardVectors(const Device& device, const PackedHistograms& vectors, int bins);

    /// The nearest word of each, and how far it is; `words` holds guesses.
    void assign(const Codebook& book, std::vector<std::uint16_t>& words, std::vector<std::int32_t>& differences) const;
    /// Some of them, which come.
    void pick(const std::vector<std::uint32_t>& which, std::vector<PackedHistogram>& found) const;
    /// Adds up the histograms of each word.
    void add_up(const std::vector<std::uint16_t>& words, std::vector<std::int64_t>& sums) const;

private:
    kernel::WordedVectors view() const;

    std::shared_ptr<cuda::Stream> stream_;
    int bins_;
    const PackedHistogram* vectors_;
    cuda::Array<std::uint16_t> words_;
    cuda::Array<std::int32_t> differences_;
    mutable CardLeftOver left_over_;
};

}  // namespace chiaro

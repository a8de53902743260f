#include "illumination/histogram/card_vectors.h"

#include "cuda/run.h"

namespace chiaro {

CardVectors::CardVectors(const Device& device, const PackedHistograms& vectors, int bins)
    : stream_(device.stream),
      bins_(bins),
      vectors_(vectors.on_card(*stream_)),
      words_(*stream_, vectors.size() / std::size_t(bins)),
      differences_(*stream_, words_.size()),
      left_over_(*stream_, words_.size()) {}

kernel::WordedVectors CardVectors::view() const {
    return {vectors_, std::int32_t(words_.size()), bins_, words_.data(), differences_.data()};
}

void CardVectors::assign(const Codebook& book, std::vector<std::uint16_t>& words,
                         std::vector<std::int32_t>& differences) const {
    const cuda::Settled settled{*stream_};
    stream_->upload(words_.data(), words.data(), words.size() * sizeof words[0]);
    kernel::assign_vectors(*stream_, book.view_on_card(*stream_), view(), left_over_.none());
    stream_->download(words.data(), words_.data(), words.size() * sizeof words[0]);
    stream_->download(differences.data(), differences_.data(), differences.size() * sizeof differences[0]);
    stream_->wait();
}

void CardVectors::pick(const std::vector<std::uint32_t>& which, std::vector<PackedHistogram>& found) const {
    const cuda::Settled settled{*stream_};
    const cuda::Array<std::uint32_t> there(*stream_, which.size());
    const cuda::Array<PackedHistogram> list(*stream_, found.size());
    stream_->upload(there.data(), which.data(), which.size() * sizeof which[0]);
    kernel::run_on_card(*stream_, std::int64_t(found.size()),
                        kernel::PickVectors{vectors_, bins_, there.data(), list.data()});
    stream_->download(found.data(), list.data(), found.size() * sizeof found[0]);
    stream_->wait();
}

void CardVectors::add_up(const std::vector<std::uint16_t>& words, std::vector<std::int64_t>& sums) const {
    const cuda::Settled settled{*stream_};
    cuda::Array<cuda::Count> there(*stream_, sums.size());
    there.zero();
    stream_->upload(words_.data(), words.data(), words.size() * sizeof words[0]);
    kernel::add_up_vectors(*stream_, view(), there.data());
    stream_->download(sums.data(), there.data(), sums.size() * sizeof sums[0]);
    stream_->wait();
}

}  // namespace chiaro

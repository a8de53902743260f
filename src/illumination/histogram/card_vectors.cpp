#include "illumination/histogram/card_vectors.h"

#include "cuda/mirror.h"

namespace chiaro {

CardVectors::CardVectors(const Device& device, const std::vector<PackedHistogram>& vectors, int bins)
    : stream_(device.stream),
      bins_(bins),
      vectors_(*stream_, vectors.size()),
      words_(*stream_, vectors.size() / std::size_t(bins)),
      differences_(*stream_, words_.size()) {
    stream_->upload(vectors_.data(), vectors.data(), vectors.size() * sizeof vectors[0]);
    stream_->wait();
}

kernel::WordedVectors CardVectors::view() const {
    return {vectors_.data(), std::int32_t(words_.size()), bins_, words_.data(), differences_.data()};
}

void CardVectors::assign(const Codebook& book, std::vector<std::uint16_t>& words,
                         std::vector<std::int32_t>& differences) const {
    HostArrays arrays;
    book.add_to(arrays);
    cuda::Views views(*stream_, std::move(arrays));
    kernel::CodebookView there = book.view();
    views.swap(there.words, there.neighbours, there.distances);
    stream_->upload(words_.data(), words.data(), words.size() * sizeof words[0]);
    kernel::assign_vectors(*stream_, there, view());
    stream_->download(words.data(), words_.data(), words.size() * sizeof words[0]);
    stream_->download(differences.data(), differences_.data(), differences.size() * sizeof differences[0]);
    stream_->wait();
}

void CardVectors::add_up(const std::vector<std::uint16_t>& words, std::vector<std::int64_t>& sums) const {
    cuda::Array<cuda::Count> there(*stream_, sums.size());
    there.zero();
    stream_->upload(words_.data(), words.data(), words.size() * sizeof words[0]);
    kernel::add_up_vectors(*stream_, view(), there.data());
    stream_->download(sums.data(), there.data(), sums.size() * sizeof sums[0]);
    stream_->wait();
}

}  // namespace chiaro

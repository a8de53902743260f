#include "illumination/histogram/gpu_vectors.h"

#include "cuda/run.h"

namespace chiaro {

GpuVectors::GpuVectors(const Device& device, const PackedHistograms& vectors, int bins)
    : stream_(device.stream),
      bins_(bins),
      vectors_(vectors.on_gpu(*stream_)),
      codewords_(*stream_, vectors.size() / std::size_t(bins)),
      differences_(*stream_, codewords_.size()),
      unresolved_(*stream_, codewords_.size()) {}

kernel::CodewordedVectors GpuVectors::view() const {
    return {vectors_, std::int32_t(codewords_.size()), bins_, codewords_.data(), differences_.data()};
}

void GpuVectors::assign(const Codebook& codebook, std::vector<std::uint16_t>& codewords,
                        std::vector<std::int32_t>& differences) const {
    const cuda::SyncOnExit sync{*stream_};
    stream_->upload(codewords_.data(), codewords.data(), codewords.size() * sizeof codewords[0]);
    kernel::assign_vectors(*stream_, codebook.view_on_gpu(*stream_), view(), unresolved_.none());
    stream_->download(codewords.data(), codewords_.data(), codewords.size() * sizeof codewords[0]);
    stream_->download(differences.data(), differences_.data(), differences.size() * sizeof differences[0]);
    stream_->wait();
}

void GpuVectors::pick(const std::vector<std::uint32_t>& which, std::vector<PackedHistogram>& found) const {
    const cuda::SyncOnExit sync{*stream_};
    const cuda::Array<std::uint32_t> there(*stream_, which.size());
    const cuda::Array<PackedHistogram> list(*stream_, found.size());
    stream_->upload(there.data(), which.data(), which.size() * sizeof which[0]);
    kernel::run_on_gpu(*stream_, std::int64_t(found.size()),
                       kernel::PickVectors{vectors_, bins_, there.data(), list.data()});
    stream_->download(found.data(), list.data(), found.size() * sizeof found[0]);
    stream_->wait();
}

void GpuVectors::add_up(const std::vector<std::uint16_t>& codewords, std::vector<std::int64_t>& sums) const {
    const cuda::SyncOnExit sync{*stream_};
    cuda::Array<cuda::Count> there(*stream_, sums.size());
    there.zero();
    stream_->upload(codewords_.data(), codewords.data(), codewords.size() * sizeof codewords[0]);
    kernel::add_up_vectors(*stream_, view(), there.data());
    stream_->download(sums.data(), there.data(), sums.size() * sizeof sums[0]);
    stream_->wait();
}

}  // namespace chiaro

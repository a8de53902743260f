#include "pathtrace/gpu.h"

#include "cuda/run.h"

namespace chiaro {

GpuPaths::GpuPaths(const Device& device, int width, int height)
    : stream_(device.stream),
      width_(width),
      height_(height),
      sums_(*stream_, std::size_t(width) * height),
      collisions_(*stream_),
      noise_(*stream_, std::size_t(kernel::NoiseKernel::runs(std::int64_t(sums_.size())))) {
    sums_.zero();
}

void GpuPaths::add_up_to(int end, const Progress& progress) {
    for (const int first = samples_; samples_ < end; ++samples_) {
        if (samples_ > first) stream_->wait();
        if (progress.cancelled()) return;
        trace(samples_);
    }
    stream_->wait();
}

void GpuPaths::show(std::shared_ptr<cuda::Pixels>& pixels) const {
    if (!pixels) pixels = std::make_shared<cuda::Pixels>(stream_, sums_.size());
    const double share = 1.0 / std::max(samples_, 1);
    kernel::run_on_gpu(*stream_, std::int64_t(sums_.size()), kernel::MeanKernel{sums_.data(), pixels->data(), share});
}

void GpuPaths::measure(std::vector<kernel::PathNoise>& runs) const {
    const auto pixels = std::int64_t(sums_.size());
    const kernel::NoiseKernel kernel{sums_.data(), noise_.data(), pixels, double(samples_)};
    kernel::run_on_gpu(*stream_, std::int64_t(noise_.size()), kernel);
    runs.resize(noise_.size());
    stream_->fetch(runs.data(), noise_.data(), runs.size() * sizeof runs[0]);
}

std::vector<PixelSum> GpuPaths::sums() const {
    std::vector<PixelSum> sums(sums_.size());
    stream_->fetch(sums.data(), sums_.data(), sums.size() * sizeof sums[0]);
    return sums;
}

}  // namespace chiaro

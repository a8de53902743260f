// A frame that stays on the GPU.
#pragma once
#include <memory>

#include "cuda/stream.h"
#include "kernel/rgba.h"

namespace chiaro::cuda {

/// The pixels, and the order of work in which they are made and read.
class Pixels {
public:
    Pixels(const std::shared_ptr<Stream>& stream, std::size_t count) : stream_(stream), pixels_(*stream, count) {}

    Stream& stream() const { return *stream_; }
    std::size_t size() const { return pixels_.size(); }
    kernel::Rgba* data() const { return pixels_.data(); }
    /// To the host, waiting for what makes them.
    void bring_to(float* rgba) const { stream_->fetch(rgba, pixels_.data(), pixels_.size() * sizeof(kernel::Rgba)); }

private:
    const std::shared_ptr<Stream> stream_;
    const Array<kernel::Rgba> pixels_;
};

}  // namespace chiaro::cuda

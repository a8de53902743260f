#include "illumination/cells/twin_buffer.h"

namespace chiaro {

const std::byte* TwinBuffer::on_card(cuda::Stream& stream) const {
    if (late_ && late_->stream->mirror() != stream.mirror()) come();  // another card made them
    return stream.mirror()->of(array(), stream);
}

void TwinBuffer::keep(const std::shared_ptr<cuda::Stream>& stream, const void* made) {
    stream->mirror()->keep(array(), made, *stream);
    late_ = std::make_unique<Late>();
    late_->stream = stream;
}

void TwinBuffer::come() const {
    std::call_once(late_->came, [this] {
        cuda::Stream& stream = *late_->stream;
        stream.download(here_.data(), on_card(stream), here_.size());
        stream.wait();
    });
}

void TwinBuffer::forget_card() {
    come();
    late_.reset();
    life_ = std::make_shared<const char>();
}

}  // namespace chiaro

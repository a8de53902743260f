#include <chiaro/image.h>

#include "cuda/pixels.h"

namespace chiaro {

const Frame& DeviceFrame::read() const {
    if (on_card_) on_card_->bring_to(frame_.rgba.data());
    on_card_.reset();
    return frame_;
}

Frame& DeviceFrame::write() {
    on_card_.reset();
    return frame_;
}

}  // namespace chiaro

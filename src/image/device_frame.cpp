#include <chiaro/image.h>

#include "cuda/pixels.h"

namespace chiaro {

const Frame& DeviceFrame::read() const {
    if (on_gpu_) on_gpu_->bring_to(frame_.rgba.data());
    on_gpu_.reset();
    return frame_;
}

Frame& DeviceFrame::write() {
    on_gpu_.reset();
    frame_.depth_mm.clear();
    return frame_;
}

}  // namespace chiaro

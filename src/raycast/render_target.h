// A frame that is being filled, here or on a GPU.
#pragma once
#include <chiaro/image.h>

#include "cuda/pixels.h"

namespace chiaro {

struct RenderTarget {
    Frame& frame;
    std::shared_ptr<cuda::Pixels> pixels = nullptr;  ///< where a GPU has them; else the frame does

    /// To the host, where the GPU has them.
    void bring() {
        if (pixels) pixels->bring_to(frame.rgba.data());
        pixels.reset();
    }
};

}  // namespace chiaro

// A frame that is being filled, here or on a card.
#pragma once
#include <chiaro/image.h>

#include "cuda/pixels.h"

namespace chiaro {

struct RenderTarget {
    Frame& frame;
    std::shared_ptr<cuda::Pixels> pixels = nullptr;  ///< where a card has them; else the frame does

    /// To the host, where the card has them.
    void bring() {
        if (pixels) pixels->bring_to(frame.rgba.data());
        pixels.reset();
    }
};

}  // namespace chiaro

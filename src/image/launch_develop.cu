// Developing on cards: the same source, a thread a pixel.
#include "cuda/launch.h"
#include "image/launch_card.h"

namespace chiaro::kernel {

template <class Encode>
void develop_pixels(cuda::Stream& stream, const DevelopKernel<Encode>& kernel, std::int64_t count) {
    cuda::launch_items(stream, count, kernel);
}

template void develop_pixels(cuda::Stream&, const DevelopKernel<SrgbCode>&, std::int64_t);
template void develop_pixels(cuda::Stream&, const DevelopKernel<RoundToByte>&, std::int64_t);

}  // namespace chiaro::kernel

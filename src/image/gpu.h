// Developing on the GPU that holds the frame.
#pragma once
#include "cuda/device_cache.h"
#include "cuda/pixels.h"
#include "cuda/run.h"
#include "image/develop_kernel.h"

namespace chiaro {

inline void swap_pointers(cuda::Views& views, kernel::SrgbCode& encode) {
    views.to_device_pointers(encode.lowest, encode.code);
}
inline void swap_pointers(cuda::Views&, kernel::RoundToByte&) {}

/// `arrays`: what the kernel's encoding points into. Fills `out`.
template <class Encode>
void develop_on_gpu(const cuda::Pixels& pixels, kernel::DevelopKernel<Encode> kernel, const HostArrays& arrays,
                    std::vector<std::uint8_t>& out) {
    cuda::Stream& stream = pixels.stream();
    cuda::Views views(stream, arrays);
    swap_pointers(views, kernel.encode);
    const cuda::Array<std::uint8_t> codes(stream, out.size());
    kernel.in = pixels.data(), kernel.out = codes.data();
    kernel::run_on_gpu(stream, std::int64_t(pixels.size()), kernel);
    stream.fetch(out.data(), codes.data(), out.size());
}

}  // namespace chiaro

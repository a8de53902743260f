// The probe behind pixels on GPUs: the same source, a thread each.
#include "cuda/launch.h"
#include "raycast/launch_background.h"

namespace chiaro::kernel {

void put_background(cuda::Stream& stream, const BackgroundKernel& kernel, std::int32_t width, std::int32_t height) {
    cuda::launch_pixels(stream, width, height, kernel);
}

}  // namespace chiaro::kernel

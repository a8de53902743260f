// Room for histograms that are left over.
#pragma once
#include "illumination/histogram/launch_gpu.h"

namespace chiaro {

class GpuUnresolved {
public:
    GpuUnresolved(cuda::Stream& stream, std::size_t most) : count_(stream, 1), which_(stream, most) {}
    /// None yet.
    kernel::Unresolved none() {
        count_.zero();
        return {count_.data(), which_.data()};
    }

private:
    cuda::Array<cuda::Count> count_;
    const cuda::Array<std::uint32_t> which_;
};

}  // namespace chiaro

// The sweep on cards: the same source, one thread a node, which is a row of one.
#include "cuda/launch.h"
#include "illumination/visibility/launch_card.h"

namespace chiaro::kernel {
namespace {

struct SweepNode {
    SweepKernel kernel;
    SweptPlane plane;

    CHIARO_ON_CARD void operator()(std::int32_t u, std::int32_t v) const {
        const std::int64_t node = v * plane.stride_v + u * plane.stride_u;
        const std::int64_t item = std::int64_t(v) * plane.nu + u;
        kernel.operator()<float>(SweepRow{(v + 1) * kernel.planes.row + u + 1, 1, plane.density + node, 0,
                                          plane.field + node * kernel.harmonics.coefficients, 0,
                                          plane.scratch + item * kernel.planes.directions});
    }
};

}  // namespace

void sweep_plane(cuda::Stream& stream, const SweepKernel& kernel, const SweptPlane& plane) {
    cuda::launch_pixels(stream, plane.nu, plane.nv, SweepNode{kernel, plane});
}

}  // namespace chiaro::kernel

// Sheared sweeps on cards: the same source, one thread a point of a lattice, then one a node.
#include "cuda/launch.h"
#include "illumination/visibility/launch_card.h"

namespace chiaro::kernel {
namespace {

struct FillDensity {
    SweptPlane plane;
    float* to;
    std::int32_t row;
    CHIARO_ON_CARD void operator()(std::int32_t u, std::int32_t v) const {
        to[std::int64_t(v) * row + u] = plane.density[v * plane.stride_v + u * plane.stride_u];
    }
};
struct FollowRays {
    ShearedKernel kernel;
    SweptPlane plane;
    CHIARO_ON_CARD void operator()(std::int64_t item) const {
        const std::int32_t columns = plane.nu + 1, rows = plane.nv + 1;
        const std::int32_t i = std::int32_t(item % columns) - 1, j = std::int32_t(item / columns % rows) - 1,
                           d = std::int32_t(item / columns / rows);
        kernel.point(d, i, j, plane.scratch + (std::int64_t(d) * plane.nv + j) * plane.nu + i);
    }
};
struct ProjectNode {
    Harmonics harmonics;
    SweptPlane plane;
    CHIARO_ON_CARD void operator()(std::int32_t u, std::int32_t v) const {
        const float* seen = plane.scratch + std::int64_t(v) * plane.nu + u;
        float* field = plane.field + (v * plane.stride_v + u * plane.stride_u) * harmonics.coefficients;
        harmonics.project<float, 1>(&seen, plane.nu * plane.nv, &field);
    }
};

}  // namespace

void sweep_sheared_plane(cuda::Stream& stream, const ShearedKernel& kernel, const SweptPlane& plane, float* density) {
    cuda::launch_pixels(stream, plane.nu, plane.nv, FillDensity{plane, density, kernel.planes.density_row});
    cuda::launch_items(stream, std::int64_t(kernel.harmonics.directions) * (plane.nu + 1) * (plane.nv + 1),
                       FollowRays{kernel, plane});
    cuda::launch_pixels(stream, plane.nu, plane.nv, ProjectNode{kernel.harmonics, plane});
}

}  // namespace chiaro::kernel

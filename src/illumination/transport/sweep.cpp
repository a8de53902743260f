#include "illumination/transport/sweep.h"

#include <cmath>

namespace chiaro {

std::vector<kernel::SweepRay> sweep_rays(const std::vector<Vec3>& directions, std::span<const SweepDirection> batch,
                                         const SweepAxes& axes, int row, const OpaqueCells& opaque) {
    std::vector<kernel::SweepRay> rays;
    for (const SweepDirection& d : batch) {
        const Vec3 w = directions[std::size_t(d.index)];
        kernel::SweepRay ray{};
        const int to_u = d.du < 0 ? -1 : 1, to_v = d.dv < 0 ? -1 : 1;
        const double u = std::abs(d.du), v = std::abs(d.dv);
        for (int tap = 0; tap < 4; ++tap) {
            const int along_u = tap & 1 ? to_u : 0, along_v = tap & 2 ? to_v : 0;
            ray.offset[tap] = along_v * row + along_u;
            ray.weight[tap] = float((tap & 1 ? u : 1 - u) * (tap & 2 ? v : 1 - v));
            ray.back[tap] = axes.sign * opaque.stride(axes.major) + along_v * opaque.stride(axes.v) +
                            along_u * opaque.stride(axes.u);
        }
        for (int axis = 0; axis < 3; ++axis) {
            ray.cosine[axis] = float(w[axis]);
            ray.octant |= (w[axis] < 0) << axis;
        }
        rays.push_back(ray);
    }
    return rays;
}

}  // namespace chiaro

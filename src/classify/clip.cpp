#include "classify/clip.h"

namespace chiaro {

std::vector<HalfSpace> half_spaces(const Clip& clip, const Geometry& geometry, const std::array<int, 3>& dimensions) {
    std::vector<HalfSpace> kept;
    if (clip.box)
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 along;
            along[axis] = 1;
            const double low = (*clip.box)[2 * axis], high = (*clip.box)[2 * axis + 1], last = dimensions[axis] - 1;
            // Fractions 0 and 1 cut nothing off: the volume's own border is no cut.
            if (low > 0) kept.push_back({-along, -low * last});
            if (high < 1) kept.push_back({along, high * last});
        }
    for (const ClipPlane& plane : clip.planes) {
        // n · (o + M v) <= d becomes (Mᵀ n) · v <= d - n · o, over the normal's length
        const double scale = 1 / length(plane.normal);
        Vec3 normal;
        for (int axis = 0; axis < 3; ++axis)
            normal[axis] = scale * geometry.spacing_mm[axis] * dot(plane.normal, geometry.direction[axis]);
        kept.push_back({normal, scale * (plane.d - dot(plane.normal, geometry.origin_mm))});
    }
    return kept;
}

}  // namespace chiaro

#include <chiaro/slice.h>

#include <algorithm>
#include <cmath>

namespace chiaro {
namespace {

/// Of the volume's axes the one that runs along each world axis: the assignment with the largest sum of cosines.
std::array<int, 3> axes_along_world(const Geometry& geometry) {
    std::array<int, 3> order{0, 1, 2}, best = order;
    double largest = -1;
    do {
        double sum = 0;
        for (int world = 0; world < 3; ++world) sum += std::abs(geometry.direction[order[world]][world]);
        if (sum > largest + 1e-9) largest = sum, best = order;
    } while (std::next_permutation(order.begin(), order.end()));
    return best;
}

}  // namespace

std::array<Section, 3> sections_of(const Geometry& geometry) {
    const bool is_framed = geometry.world != World::unknown;
    const std::array<int, 3> axis = is_framed ? axes_along_world(geometry) : std::array{0, 1, 2};
    // Towards the patient's left, back and head; LPS itself.
    const double side = geometry.world == World::ras ? -1 : 1;
    const auto towards = [&](int world) {
        const Vec3 d = geometry.direction[axis[world]];
        const double sign = world == 2 ? 1 : side;
        return !is_framed || sign * d[world] >= 0 ? d : -d;
    };
    const Vec3 left = towards(0), back = towards(1), head = towards(2);
    return {Section{is_framed ? "axial" : "z", axis[2], left, back},
            Section{is_framed ? "coronal" : "y", axis[1], left, -head},
            Section{is_framed ? "sagittal" : "x", axis[0], back, -head}};
}

}  // namespace chiaro

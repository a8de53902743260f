#include "illumination/sh/directions.h"

#include <algorithm>

namespace chiaro {

std::vector<Vec3> jittered_directions(int count, int set) {
    // Rings of equal height hold cells about as high as they are wide at the equator; each has its share of the N.
    const int rings = std::max(1, int(std::lround(std::sqrt(count / std::numbers::pi))));
    std::uint64_t counter = std::uint64_t(set) << 32;
    const auto random = [&] { return double(scrambled(counter++) >> 11) * 0x1p-53; };
    std::vector<Vec3> directions;
    for (int ring = 0; ring < rings; ++ring) {
        const int first = int(std::int64_t(ring) * count / rings), end = int(std::int64_t(ring + 1) * count / rings);
        for (int cell = 0; cell < end - first; ++cell) {
            const double z = 1 - 2 * (first + random() * (end - first)) / count;
            const double phi = 2 * std::numbers::pi * (cell + random()) / (end - first);
            const double r = std::sqrt(std::max(0.0, 1 - z * z));
            directions.push_back({r * std::cos(phi), r * std::sin(phi), z});
        }
    }
    return directions;
}

}  // namespace chiaro

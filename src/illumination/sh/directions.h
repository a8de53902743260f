// Directions spread evenly over the sphere.
#pragma once
#include <chiaro/geometry.h>

#include <cstdint>
#include <numbers>
#include <vector>

#include "illumination/sh/scrambled.h"

namespace chiaro {

/// The Fibonacci set: z = 1 - 2 (i + ½) / N, φ = (i + ½) π (3 - √5).
inline std::vector<Vec3> fibonacci_directions(int count) {
    constexpr double golden_angle = std::numbers::pi * (3 - 2.23606797749978969641);
    std::vector<Vec3> directions;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z), phi = (i + 0.5) * golden_angle;
        directions.push_back({r * std::cos(phi), r * std::sin(phi), z});
    }
    return directions;
}

/// One of many sets of N directions, each at random within its own N-th of the sphere. The same wherever it is asked
/// for.
std::vector<Vec3> jittered_directions(int count, int set);

using kernel::scrambled;

}  // namespace chiaro

#include "illumination/transport/directions.h"

#include <bit>
#include <cmath>
#include <numbers>

#include "illumination/sh/directions.h"
#include "illumination/sh/rotation.h"

namespace chiaro {
namespace {

/// The 24 images of a direction under the rotations of a cube.
std::vector<Vec3> orbit_of(Vec3 d) {
    static constexpr int axes[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    std::vector<Vec3> orbit;
    for (int turn = 0; turn < 6; ++turn)
        for (int signs = 0; signs < 8; ++signs) {
            // A rotation: even permutations go with an even number of changed signs, odd ones with an odd number.
            if (std::popcount(unsigned(signs)) % 2 != (turn >= 3)) continue;
            const auto [a, b, c] = axes[turn];
            orbit.push_back({signs & 1 ? -d[a] : d[a], signs & 2 ? -d[b] : d[b], signs & 4 ? -d[c] : d[c]});
        }
    return orbit;
}

Axes rotation(double u, double v, double w) {
    constexpr double turn = 2 * std::numbers::pi;
    const double a = std::sqrt(1 - u), b = std::sqrt(u);
    const double x = a * std::sin(turn * v), y = a * std::cos(turn * v), z = b * std::sin(turn * w),
                 s = b * std::cos(turn * w);
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y + z * s), 2 * (x * z - y * s)},
             {2 * (x * y - z * s), 1 - 2 * (x * x + z * z), 2 * (y * z + x * s)},
             {2 * (x * z + y * s), 2 * (y * z - x * s), 1 - 2 * (x * x + y * y)}}};
}

}  // namespace

std::vector<Vec3> turned_directions(int count, int index, std::uint64_t seed) {
    std::vector<Vec3> directions =
        count == 24 ? orbit_of({0.2666354015, 0.4225186538, 0.8662468181}) : fibonacci_directions(count);
    const auto place = [&](int axis, double step) {
        const double first = double(scrambled(3 * seed + std::uint64_t(axis)) >> 11) * 0x1p-53,
                     s = first + index * step;
        return s - std::floor(s);
    };
    const Axes turn =
        rotation(place(0, 0.8191725133961645), place(1, 0.6710436067037893), place(2, 0.5497004779019703));
    for (Vec3& d : directions) d = normalized(turned(turn, d));
    return directions;
}

}  // namespace chiaro

// An order in which bricks that lie near each other come soon after each other.
#pragma once
#include <array>
#include <cstdint>

namespace chiaro {

/// A brick's place along Morton's curve: bricks in this order share what lies around them.
constexpr std::uint64_t place_on_curve(const std::array<int, 3>& at) {
    std::uint64_t place = 0;
    for (unsigned bit = 0; bit < 16; ++bit)
        for (unsigned axis = 0; axis < 3; ++axis) place |= std::uint64_t(at[axis] >> bit & 1) << (3 * bit + axis);
    return place;
}

}  // namespace chiaro

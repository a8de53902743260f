// Numbers that look random and depend on nothing but what they are asked for.
#pragma once
#include <cstdint>

namespace chiaro {

/// SplitMix64's mixing of a number (Steele, Lea and Flood 2014).
constexpr std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
}
/// In [0, 1).
constexpr double random_share(std::uint64_t x) { return double(mixed(x) >> 11) * 0x1p-53; }

}  // namespace chiaro

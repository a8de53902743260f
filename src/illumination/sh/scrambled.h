// Random bits by counting.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// Well mixed bits of a counter: SplitMix64, but with its first multiplier in the place of the second
/// (0x94d049bb133111eb) too. A slip, kept because jittered directions, and so pictures, would change with it.
CHIARO_INLINE std::uint64_t scrambled(std::uint64_t counter) {
    std::uint64_t bits = (counter + 1) * 0x9e3779b97f4a7c15u;
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ bits >> 27) * 0xbf58476d1ce4e5b9u;
    return bits ^ bits >> 31;
}

}  // namespace chiaro::kernel

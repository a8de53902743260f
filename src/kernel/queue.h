// Lanes that take their work from a queue: whose is ended hands its result over and takes the next.
#pragma once
#include "kernel/rgba.h"

namespace chiaro::kernel {

/// How many of the lanes before each one are set.
CHIARO_INLINE std::int32_t set_before(bool) { return 0; }

/// results[place] = colour for the lanes that are set.
CHIARO_INLINE void hand_over(bool set, std::int32_t place, Vec3<float> colour, float alpha, Rgba* results) {
    if (set) results[place] = {colour.x, colour.y, colour.z, alpha};
}

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {
CHIARO_INLINE IntLanes set_before(MaskLanes m) {
    const unsigned bits = bits_of(m);
    std::int32_t before[16];
    for (int i = 0, sum = 0; i < 16; ++i) {
        before[i] = sum;
        sum += int(bits >> i & 1);
    }
    IntLanes lanes;
    __builtin_memcpy(&lanes, before, sizeof lanes);
    return lanes;
}

CHIARO_INLINE void hand_over(MaskLanes set, IntLanes place, Vec3<Lanes> colour, Lanes alpha, Rgba* results) {
    float r[16], g[16], b[16], a[16];
    std::int32_t at[16];
    __builtin_memcpy(r, &colour.x, sizeof r), __builtin_memcpy(g, &colour.y, sizeof g);
    __builtin_memcpy(b, &colour.z, sizeof b), __builtin_memcpy(a, &alpha, sizeof a);
    __builtin_memcpy(at, &place, sizeof at);
    for (unsigned bits = bits_of(set); bits; bits &= bits - 1) {
        const int i = __builtin_ctz(bits);
        results[at[i]] = {r[i], g[i], b[i], a[i]};
    }
}
}  // namespace CHIARO_ISA
#endif

}  // namespace chiaro::kernel

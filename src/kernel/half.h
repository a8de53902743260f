// Numbers in 16 bits: as floats are, with 5 bits of exponent and 10 of fraction (IEEE 754 binary16).
#pragma once
#include "kernel/gather.h"

namespace chiaro::kernel {

/// Finite halves; those too small for one are kept as what they are.
CHIARO_INLINE float from_half(std::uint16_t half) {
    const float size = float_of(std::int32_t(half & 0x7fff) << 13) * 5.192296858534828e33f;  // 2^112
    return half & 0x8000 ? -size : size;
}
/// The nearest half, ties to even; |value| < 65520.
CHIARO_INLINE std::uint16_t to_half(float value) {
    const std::int32_t sign = (bits_of(value) >> 16) & 0x8000;
    const float size = abs(value);
    // Below 2^-14 halves are as far apart as 2^-24: adding 2^-1 rounds to that.
    if (size < 6.103515625e-05f) return std::uint16_t(sign | (bits_of(size + 0.5f) - bits_of(0.5f)));
    const std::int32_t bits = bits_of(size), odd = (bits >> 13) & 1;
    return std::uint16_t(sign | ((bits + 0xfff + odd - (112 << 23)) >> 13));
}

/// A half of at least 2^-14, or 0, which reads as 2^-15: so its bits need only be shifted, and no sum of a few is so
/// small that it takes a CPU long.
struct Light16 {
    static constexpr float most = 65504;
    std::uint16_t bits;
};
/// 0 to Light16::most; beyond as there.
CHIARO_INLINE Light16 to_light(float value) {
    const float least = 6.103515625e-05f, size = min(max(value, least), Light16::most);
    return {value < least ? std::uint16_t(0) : to_half(size)};
}
CHIARO_INLINE float to_float(Light16 v) { return float_of((std::int32_t(v.bits) << 13) + (112 << 23)); }
CHIARO_INLINE Two<float> load_two(const Light16* p) { return {to_float(p[0]), to_float(p[1])}; }

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {

CHIARO_INLINE Two<Lanes> split_light(IntLanes word) {
    const IntLanes exponent(112 << 23);
    return {float_of(((word & IntLanes(0x7fff)) << IntLanes(13)) + exponent),
            float_of(((word >> IntLanes(3)) & IntLanes(0x7fff << 13)) + exponent)};
}
CHIARO_INLINE Four<Two<Lanes>> gather_two(const Light16* p, const Indices& i, Distances at) {
    const Four<IntLanes> w = gather_words(p, i, at);
    return {split_light(w.a), split_light(w.b), split_light(w.c), split_light(w.d)};
}

}  // namespace CHIARO_ISA
#endif

}  // namespace chiaro::kernel

// Random numbers by counting: a function of (seed, pixel, sample, dimension) and of nothing else, so that a picture
// does not depend on who draws when. The hash is pcg3d of Jarzynski and Olano, Hash Functions for GPU Rendering (JCGT
// 2020).
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// a b + c modulo 2^32.
CHIARO_INLINE std::int32_t wrapping_mad(std::int32_t a, std::int32_t b, std::int32_t c) {
    return std::int32_t(std::uint32_t(a) * std::uint32_t(b) + std::uint32_t(c));
}
/// a xor (a >> 16), of unsigned words.
CHIARO_INLINE std::int32_t fold(std::int32_t a) { return std::int32_t(std::uint32_t(a) ^ (std::uint32_t(a) >> 16)); }
/// The upper 23 bits, of an unsigned word.
CHIARO_INLINE std::int32_t upper_bits(std::int32_t a) { return std::int32_t(std::uint32_t(a) >> 9); }

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {
typedef VectorOf<std::uint32_t, native_bytes / 4>::type NativeWords;
CHIARO_INLINE IntLanes wrapping_mad(IntLanes a, IntLanes b, IntLanes c) {
    return map<std::int32_t, 16>(
        [](auto u, auto v, auto w)
            __attribute__((always_inline)) { return NativeInt(NativeWords(u) * NativeWords(v) + NativeWords(w)); },
        a, b, c);
}
CHIARO_INLINE IntLanes fold(IntLanes a) {
    return map<std::int32_t, 16>(
        [](auto u) __attribute__((always_inline)) { return NativeInt(NativeWords(u) ^ (NativeWords(u) >> 16)); }, a);
}
CHIARO_INLINE IntLanes upper_bits(IntLanes a) {
    return map<std::int32_t, 16>(
        [](auto u) __attribute__((always_inline)) { return NativeInt(NativeWords(u) >> 9); }, a);
}
}  // namespace CHIARO_ISA
#endif

/// The first step of the hash, which does not mix.
template <class I>
CHIARO_INLINE I congruent(I counter) {
    return wrapping_mad(counter, I(1664525), I(1013904223));
}

/// What is drawn from for one sample of one pixel.
template <class F>
struct RandomKey {
    Int<F> pixel, sample;  ///< congruent
};
template <class F>
CHIARO_INLINE RandomKey<F> random_key(Int<F> pixel, Int<F> sample) {
    return {congruent(pixel), congruent(sample)};
}

/// Numbers in (0, 1): odd multiples of 2^-24.
template <class F>
struct Draw {
    F a, b, c;
};

/// Three numbers at a time, of dimension 0, 1, ...
template <class F>
CHIARO_INLINE Draw<F> draw(const RandomKey<F>& key, Int<F> dimension) {
    Int<F> x = key.pixel, y = key.sample, z = congruent(dimension);
    const auto mix = [&]() CHIARO_INLINE_LAMBDA {
        x = wrapping_mad(y, z, x);
        y = wrapping_mad(z, x, y);
        z = wrapping_mad(x, y, z);
    };
    mix();
    x = fold(x), y = fold(y), z = fold(z);
    mix();
    const auto number = [](Int<F> word)
                            CHIARO_INLINE_LAMBDA { return (to_float(upper_bits(word)) + F(0.5f)) * F(1.0f / 8388608); };
    return {number(x), number(y), number(z)};
}

}  // namespace chiaro::kernel

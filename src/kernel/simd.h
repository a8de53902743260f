// Sixteen lanes on GCC's vector types. A Pack is one native vector, or two halves of one where the machine is narrower,
// so that every operation is written once and every instruction set has sixteen lanes (native widths lose half: the
// overhead of the march is per step, not per lane).
#pragma once
#include <immintrin.h>

#include "kernel/lanes.h"

namespace chiaro::kernel {
inline namespace CHIARO_ISA {

#if defined(__AVX512F__)
inline constexpr int native_bytes = 64;
#elif defined(__AVX2__)
inline constexpr int native_bytes = 32;
#else
inline constexpr int native_bytes = 16;
#endif

template <class T, int N>
inline constexpr bool is_native = sizeof(T) * N <= native_bytes;

template <class T, int N, bool native = is_native<T, N>>
struct Pack;

template <class T, int N>
struct VectorOf {
    typedef T type __attribute__((vector_size(sizeof(T) * N)));
};

template <class T, int N>
struct Pack<T, N, true> {
    using V = typename VectorOf<T, N>::type;
    V v;
    Pack() = default;
    CHIARO_INLINE Pack(V vector) : v(vector) {}
    CHIARO_INLINE Pack(T same) : v(same - V{}) {}
};

template <class T, int N>
struct Pack<T, N, false> {
    Pack<T, N / 2> lo, hi;
    Pack() = default;
    CHIARO_INLINE Pack(Pack<T, N / 2> low, Pack<T, N / 2> high) : lo(low), hi(high) {}
    CHIARO_INLINE Pack(T same) : lo(same), hi(same) {}
};

/// Applies op to the native vectors of the packs.
template <class R, int N, class Op, class... P>
CHIARO_INLINE Pack<R, N> map(Op op, P... p) {
    if constexpr (is_native<R, N>)
        return Pack<R, N>(op(p.v...));
    else
        return {map<R, N / 2>(op, p.lo...), map<R, N / 2>(op, p.hi...)};
}

using Lanes = Pack<float, 16>;
using IntLanes = Pack<std::int32_t, 16>;
#if defined(__AVX512F__)
/// A bit per lane, as registers for masks have it.
struct MaskLanes {
    __mmask16 bits;
};
#else
/// All bits set where true.
struct MaskLanes {
    IntLanes bits;
};
#endif

#define CHIARO_OP(expression) \
    [](auto u, auto v) __attribute__((always_inline)) { return expression; }
#define CHIARO_ARITHMETIC(op)                                                                             \
    CHIARO_INLINE Lanes operator op(Lanes a, Lanes b) { return map<float, 16>(CHIARO_OP(u op v), a, b); } \
    CHIARO_INLINE IntLanes operator op(IntLanes a, IntLanes b) {                                          \
        return map<std::int32_t, 16>(CHIARO_OP(u op v), a, b);                                            \
    }
CHIARO_ARITHMETIC(+)
CHIARO_ARITHMETIC(-)
CHIARO_ARITHMETIC(*)
#undef CHIARO_ARITHMETIC
CHIARO_INLINE Lanes operator/(Lanes a, Lanes b) { return map<float, 16>(CHIARO_OP(u / v), a, b); }
CHIARO_INLINE Lanes operator-(Lanes a) { return Lanes(-0.0f) - a; }
CHIARO_INLINE Lanes& operator+=(Lanes& a, Lanes b) { return a = a + b; }
CHIARO_INLINE Lanes& operator*=(Lanes& a, Lanes b) { return a = a * b; }
CHIARO_INLINE IntLanes& operator+=(IntLanes& a, IntLanes b) { return a = a + b; }

CHIARO_INLINE IntLanes operator&(IntLanes a, IntLanes b) { return map<std::int32_t, 16>(CHIARO_OP(u & v), a, b); }
CHIARO_INLINE IntLanes operator|(IntLanes a, IntLanes b) { return map<std::int32_t, 16>(CHIARO_OP(u | v), a, b); }
CHIARO_INLINE IntLanes operator<<(IntLanes a, IntLanes b) { return map<std::int32_t, 16>(CHIARO_OP(u << v), a, b); }
/// Arithmetic, as for int: mask what may be negative.
CHIARO_INLINE IntLanes operator>>(IntLanes a, IntLanes b) { return map<std::int32_t, 16>(CHIARO_OP(u >> v), a, b); }

#if defined(__AVX512F__)
#define CHIARO_COMPARE(op, of_floats, of_ints)                                                                  \
    CHIARO_INLINE MaskLanes operator op(Lanes a, Lanes b) { return {_mm512_cmp_ps_mask(a.v, b.v, of_floats)}; } \
    CHIARO_INLINE MaskLanes operator op(IntLanes a, IntLanes b) {                                               \
        return {_mm512_cmp_epi32_mask(__m512i(a.v), __m512i(b.v), of_ints)};                                    \
    }
CHIARO_COMPARE(<, _CMP_LT_OS, _MM_CMPINT_LT)
CHIARO_COMPARE(<=, _CMP_LE_OS, _MM_CMPINT_LE)
CHIARO_COMPARE(>, _CMP_GT_OS, _MM_CMPINT_NLE)
CHIARO_COMPARE(>=, _CMP_GE_OS, _MM_CMPINT_NLT)
CHIARO_COMPARE(==, _CMP_EQ_OQ, _MM_CMPINT_EQ)
CHIARO_COMPARE(!=, _CMP_NEQ_UQ, _MM_CMPINT_NE)
CHIARO_INLINE MaskLanes operator&(MaskLanes a, MaskLanes b) { return {__mmask16(a.bits & b.bits)}; }
CHIARO_INLINE MaskLanes operator|(MaskLanes a, MaskLanes b) { return {__mmask16(a.bits | b.bits)}; }
CHIARO_INLINE MaskLanes operator!(MaskLanes a) { return {__mmask16(~a.bits)}; }
#else
#define CHIARO_COMPARE(op)                                                                                             \
    CHIARO_INLINE MaskLanes operator op(Lanes a, Lanes b) { return {map<std::int32_t, 16>(CHIARO_OP(u op v), a, b)}; } \
    CHIARO_INLINE MaskLanes operator op(IntLanes a, IntLanes b) {                                                      \
        return {map<std::int32_t, 16>(CHIARO_OP(u op v), a, b)};                                                       \
    }
CHIARO_COMPARE(<)
CHIARO_COMPARE(<=)
CHIARO_COMPARE(>)
CHIARO_COMPARE(>=)
CHIARO_COMPARE(==)
CHIARO_COMPARE(!=)
CHIARO_INLINE MaskLanes operator&(MaskLanes a, MaskLanes b) { return {a.bits & b.bits}; }
CHIARO_INLINE MaskLanes operator|(MaskLanes a, MaskLanes b) { return {a.bits | b.bits}; }
CHIARO_INLINE MaskLanes operator!(MaskLanes a) {
    return {map<std::int32_t, 16>(
        [](auto m) __attribute__((always_inline)) { return ~m; }, a.bits)};
}
#endif
#undef CHIARO_COMPARE
CHIARO_INLINE MaskLanes& operator&=(MaskLanes& a, MaskLanes b) { return a = a & b; }

}  // namespace CHIARO_ISA

template <>
struct LaneTraits<Lanes> {
    using Int = IntLanes;
    using Mask = MaskLanes;
    static constexpr int count = 16;
};

// What needs an instruction of its own, per native width.
inline namespace CHIARO_ISA {
#if defined(__AVX512F__)
typedef Pack<float, 16>::V NativeFloat;
typedef Pack<std::int32_t, 16>::V NativeInt;
CHIARO_INLINE NativeFloat native_min(NativeFloat a, NativeFloat b) { return _mm512_min_ps(a, b); }
CHIARO_INLINE NativeFloat native_max(NativeFloat a, NativeFloat b) { return _mm512_max_ps(a, b); }
CHIARO_INLINE NativeInt native_min(NativeInt a, NativeInt b) {
    return NativeInt(_mm512_min_epi32(__m512i(a), __m512i(b)));
}
CHIARO_INLINE NativeInt native_max(NativeInt a, NativeInt b) {
    return NativeInt(_mm512_max_epi32(__m512i(a), __m512i(b)));
}
CHIARO_INLINE NativeFloat native_sqrt(NativeFloat a) { return _mm512_sqrt_ps(a); }
CHIARO_INLINE NativeInt native_widened(const std::int8_t* from) {
    return NativeInt(_mm512_cvtepi8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from))));
}
CHIARO_INLINE NativeFloat native_floor(NativeFloat a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
template <int imm>
CHIARO_INLINE NativeFloat native_shuffle(NativeFloat a, NativeFloat b) {
    return _mm512_shuffle_ps(a, b, imm);
}
#elif defined(__AVX2__)
typedef Pack<float, 8>::V NativeFloat;
typedef Pack<std::int32_t, 8>::V NativeInt;
CHIARO_INLINE NativeFloat native_min(NativeFloat a, NativeFloat b) { return _mm256_min_ps(a, b); }
CHIARO_INLINE NativeFloat native_max(NativeFloat a, NativeFloat b) { return _mm256_max_ps(a, b); }
CHIARO_INLINE NativeInt native_min(NativeInt a, NativeInt b) {
    return NativeInt(_mm256_min_epi32(__m256i(a), __m256i(b)));
}
CHIARO_INLINE NativeInt native_max(NativeInt a, NativeInt b) {
    return NativeInt(_mm256_max_epi32(__m256i(a), __m256i(b)));
}
CHIARO_INLINE NativeFloat native_sqrt(NativeFloat a) { return _mm256_sqrt_ps(a); }
CHIARO_INLINE NativeInt native_widened(const std::int8_t* from) {
    return NativeInt(_mm256_cvtepi8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from))));
}
CHIARO_INLINE NativeFloat native_floor(NativeFloat a) { return _mm256_floor_ps(a); }
CHIARO_INLINE unsigned native_bits(NativeInt m) { return unsigned(_mm256_movemask_ps(__m256(m))); }
template <int imm>
CHIARO_INLINE NativeFloat native_shuffle(NativeFloat a, NativeFloat b) {
    return _mm256_shuffle_ps(a, b, imm);
}
CHIARO_INLINE NativeInt native_select(NativeInt m, NativeInt a, NativeInt b) {
    return NativeInt(_mm256_blendv_ps(__m256(b), __m256(a), __m256(m)));
}
#else
typedef Pack<float, 4>::V NativeFloat;
typedef Pack<std::int32_t, 4>::V NativeInt;
CHIARO_INLINE NativeFloat native_min(NativeFloat a, NativeFloat b) { return _mm_min_ps(a, b); }
CHIARO_INLINE NativeFloat native_max(NativeFloat a, NativeFloat b) { return _mm_max_ps(a, b); }
CHIARO_INLINE NativeInt native_min(NativeInt a, NativeInt b) {
    return NativeInt(_mm_min_epi32(__m128i(a), __m128i(b)));
}
CHIARO_INLINE NativeInt native_max(NativeInt a, NativeInt b) {
    return NativeInt(_mm_max_epi32(__m128i(a), __m128i(b)));
}
CHIARO_INLINE NativeFloat native_sqrt(NativeFloat a) { return _mm_sqrt_ps(a); }
CHIARO_INLINE NativeInt native_widened(const std::int8_t* from) {
    std::int32_t four;
    __builtin_memcpy(&four, from, sizeof four);
    return NativeInt(_mm_cvtepi8_epi32(_mm_cvtsi32_si128(four)));
}
CHIARO_INLINE NativeFloat native_floor(NativeFloat a) { return _mm_floor_ps(a); }
CHIARO_INLINE unsigned native_bits(NativeInt m) { return unsigned(_mm_movemask_ps(__m128(m))); }
template <int imm>
CHIARO_INLINE NativeFloat native_shuffle(NativeFloat a, NativeFloat b) {
    return _mm_shuffle_ps(a, b, imm);
}
CHIARO_INLINE NativeInt native_select(NativeInt m, NativeInt a, NativeInt b) {
    return NativeInt(_mm_blendv_ps(__m128(b), __m128(a), __m128(m)));
}
#endif

CHIARO_INLINE Lanes min(Lanes a, Lanes b) { return map<float, 16>(CHIARO_OP(native_min(u, v)), a, b); }
CHIARO_INLINE Lanes max(Lanes a, Lanes b) { return map<float, 16>(CHIARO_OP(native_max(u, v)), a, b); }
CHIARO_INLINE IntLanes min(IntLanes a, IntLanes b) { return map<std::int32_t, 16>(CHIARO_OP(native_min(u, v)), a, b); }
CHIARO_INLINE IntLanes max(IntLanes a, IntLanes b) { return map<std::int32_t, 16>(CHIARO_OP(native_max(u, v)), a, b); }
#undef CHIARO_OP

#define CHIARO_UNARY(expression) \
    [](auto u) __attribute__((always_inline)) { return expression; }
CHIARO_INLINE Lanes sqrt(Lanes a) { return map<float, 16>(CHIARO_UNARY(native_sqrt(u)), a); }
CHIARO_INLINE Lanes floor(Lanes a) { return map<float, 16>(CHIARO_UNARY(native_floor(u)), a); }
CHIARO_INLINE Lanes to_float(IntLanes a) {
    return map<float, 16>(CHIARO_UNARY(__builtin_convertvector(u, NativeFloat)), a);
}
CHIARO_INLINE IntLanes truncate(Lanes a) {
    return map<std::int32_t, 16>(CHIARO_UNARY(__builtin_convertvector(u, NativeInt)), a);
}
CHIARO_INLINE IntLanes bits_of(Lanes a) { return map<std::int32_t, 16>(CHIARO_UNARY(NativeInt(u)), a); }
CHIARO_INLINE Lanes float_of(IntLanes a) { return map<float, 16>(CHIARO_UNARY(NativeFloat(u)), a); }
#undef CHIARO_UNARY
CHIARO_INLINE Lanes abs(Lanes a) { return float_of(bits_of(a) & IntLanes(0x7fffffff)); }

CHIARO_INLINE Lanes mad(Lanes a, Lanes b, Lanes c) { return a * b + c; }
#if defined(__AVX512F__)
CHIARO_INLINE IntLanes select(MaskLanes m, IntLanes a, IntLanes b) {
    return IntLanes(NativeInt(_mm512_mask_blend_epi32(m.bits, __m512i(b.v), __m512i(a.v))));
}
/// Bit i: lane i.
CHIARO_INLINE unsigned bits_of(MaskLanes m) { return m.bits; }
#else
CHIARO_INLINE IntLanes select(MaskLanes m, IntLanes a, IntLanes b) {
    return map<std::int32_t, 16>(
        [](auto x, auto y, auto z) __attribute__((always_inline)) { return native_select(x, y, z); }, m.bits, a, b);
}
template <int N>
CHIARO_INLINE unsigned mask_bits(Pack<std::int32_t, N> m) {
    if constexpr (is_native<std::int32_t, N>)
        return native_bits(m.v);
    else
        return mask_bits(m.lo) | mask_bits(m.hi) << (N / 2);
}
/// Bit i: lane i.
CHIARO_INLINE unsigned bits_of(MaskLanes m) { return mask_bits(m.bits); }
#endif
CHIARO_INLINE Lanes select(MaskLanes m, Lanes a, Lanes b) { return float_of(select(m, bits_of(a), bits_of(b))); }
CHIARO_INLINE bool any(MaskLanes m) { return bits_of(m) != 0; }
CHIARO_INLINE int count(MaskLanes m) { return __builtin_popcount(bits_of(m)); }
// Without a mask in between, which costs where the machine keeps masks in registers of their own.
CHIARO_INLINE Lanes zero_below(Lanes a, Lanes limit, Lanes b) {
    return map<float, 16>(
        [](auto u, auto v, auto w) __attribute__((always_inline)) { return u < v ? decltype(w){} : w; }, a, limit, b);
}

}  // namespace CHIARO_ISA
}  // namespace chiaro::kernel

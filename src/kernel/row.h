// Numbers that lie next to each other in memory: one, or sixteen at a time.
#pragma once
#include <utility>

#include "kernel/math.h"

namespace chiaro::kernel {

/// 16-bit numbers: one, or sixteen.
template <class F>
struct ShortsOf;
template <>
struct ShortsOf<float> {
    using type = std::uint16_t;
};
template <class F>
using Shorts = typename ShortsOf<F>::type;

CHIARO_INLINE void load(const std::uint16_t* from, std::uint16_t& shorts) { shorts = *from; }
CHIARO_INLINE void store(std::uint16_t shorts, std::uint16_t* to) { *to = shorts; }
/// The mean of each pair, rounded up.
CHIARO_INLINE std::uint16_t mean_of(std::uint16_t a, std::uint16_t b) { return std::uint16_t((a + b + 1) >> 1); }
CHIARO_INLINE bool is_zero(std::uint16_t shorts) { return shorts == 0; }
/// Whole numbers up to 65535.
CHIARO_INLINE float to_float(std::uint16_t shorts) { return float(shorts); }
CHIARO_INLINE void store_whole(std::int32_t values, std::uint16_t* to) { *to = std::uint16_t(values); }
/// a0 b0 a1 b1 ...
CHIARO_INLINE void store_interleaved(std::uint16_t a, std::uint16_t b, std::uint16_t* to) { to[0] = a, to[1] = b; }

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {

using ShortLanes = Pack<std::uint16_t, 16>;

/// A vector wherever it lies. Copied as bytes it would come in pieces through the stack, and wait there.
template <class V>
struct Anywhere {
    typedef V type __attribute__((aligned(2), may_alias));
};
template <class V>
CHIARO_INLINE V load_vector(const std::uint16_t* from) {
    return *reinterpret_cast<const typename Anywhere<V>::type*>(from);
}
template <class V>
CHIARO_INLINE void store_vector(V v, std::uint16_t* to) {
    *reinterpret_cast<typename Anywhere<V>::type*>(to) = v;
}

template <int N>
CHIARO_INLINE void load(const std::uint16_t* from, Pack<std::uint16_t, N>& shorts) {
    if constexpr (is_native<std::uint16_t, N>)
        shorts.v = load_vector<typename Pack<std::uint16_t, N>::V>(from);
    else
        load(from, shorts.lo), load(from + N / 2, shorts.hi);
}
template <int N>
CHIARO_INLINE void store(Pack<std::uint16_t, N> shorts, std::uint16_t* to) {
    if constexpr (is_native<std::uint16_t, N>)
        store_vector(shorts.v, to);
    else
        store(shorts.lo, to), store(shorts.hi, to + N / 2);
}

typedef VectorOf<std::uint16_t, 8>::type NativeShorts8;
CHIARO_INLINE NativeShorts8 native_mean(NativeShorts8 a, NativeShorts8 b) {
    return NativeShorts8(_mm_avg_epu16(__m128i(a), __m128i(b)));
}
CHIARO_INLINE void native_interleave(NativeShorts8 a, NativeShorts8 b, std::uint16_t* to) {
    const NativeShorts8 low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11),
                        high = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
    store_vector(low, to);
    store_vector(high, to + 8);
}
#if defined(__AVX2__)
typedef VectorOf<std::uint16_t, 16>::type NativeShorts16;
CHIARO_INLINE NativeShorts16 native_mean(NativeShorts16 a, NativeShorts16 b) {
    return NativeShorts16(_mm256_avg_epu16(__m256i(a), __m256i(b)));
}
CHIARO_INLINE void native_interleave(NativeShorts16 a, NativeShorts16 b, std::uint16_t* to) {
    const NativeShorts16 low = __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23),
                         high = __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15,
                                                        31);
    store_vector(low, to);
    store_vector(high, to + 16);
}
#endif

template <int N>
struct ShortHalves {
    Pack<std::uint16_t, N / 2> low, high;
};
CHIARO_INLINE ShortHalves<8> split(NativeShorts8 v) {
    typedef VectorOf<std::uint16_t, 4>::type V;
    return {V(__builtin_shufflevector(v, v, 0, 1, 2, 3)), V(__builtin_shufflevector(v, v, 4, 5, 6, 7))};
}
#if defined(__AVX2__)
CHIARO_INLINE ShortHalves<16> split(NativeShorts16 v) {
    return {NativeShorts8(_mm256_castsi256_si128(__m256i(v))), NativeShorts8(_mm256_extracti128_si256(__m256i(v), 1))};
}
#endif

// All words at once: the compiler's own conversions go by halves.
#if defined(__AVX512F__)
CHIARO_INLINE NativeInt native_widen(NativeShorts16 v) { return NativeInt(_mm512_cvtepu16_epi32(__m256i(v))); }
CHIARO_INLINE NativeShorts16 native_narrow(NativeInt v) { return NativeShorts16(_mm512_cvtepi32_epi16(__m512i(v))); }
#elif defined(__AVX2__)
CHIARO_INLINE NativeInt native_widen(NativeShorts8 v) { return NativeInt(_mm256_cvtepu16_epi32(__m128i(v))); }
CHIARO_INLINE NativeShorts8 native_narrow(NativeInt v) { return __builtin_convertvector(v, NativeShorts8); }
#else
typedef VectorOf<std::uint16_t, 4>::type NativeShorts4;
CHIARO_INLINE NativeInt native_widen(NativeShorts4 v) { return __builtin_convertvector(v, NativeInt); }
CHIARO_INLINE NativeShorts4 native_narrow(NativeInt v) { return __builtin_convertvector(v, NativeShorts4); }
#endif

CHIARO_INLINE ShortLanes mean_of(ShortLanes a, ShortLanes b) {
    return map<std::uint16_t, 16>(
        [](auto u, auto v) __attribute__((always_inline)) { return native_mean(u, v); }, a, b);
}
template <int N>
CHIARO_INLINE bool is_zero(Pack<std::uint16_t, N> shorts) {
    if constexpr (sizeof shorts > 32)
        return is_zero(shorts.lo) && is_zero(shorts.hi);
    else if constexpr (!is_native<std::uint16_t, N>)
        return is_zero(Pack<std::uint16_t, N / 2>(shorts.lo.v | shorts.hi.v));
    else if constexpr (sizeof shorts == 16)
        return _mm_testz_si128(__m128i(shorts.v), __m128i(shorts.v));
#if defined(__AVX2__)
    else
        return _mm256_testz_si256(__m256i(shorts.v), __m256i(shorts.v));
#endif
}
template <int N>
CHIARO_INLINE void store_interleaved(Pack<std::uint16_t, N> a, Pack<std::uint16_t, N> b, std::uint16_t* to) {
    if constexpr (is_native<std::uint16_t, N>) {
        native_interleave(a.v, b.v, to);
    } else {
        store_interleaved<N / 2>(a.lo, b.lo, to);
        store_interleaved<N / 2>(a.hi, b.hi, to + N);
    }
}

/// Shorts to words and back, as wide as the machine's words are.
template <int N>
CHIARO_INLINE Pack<std::int32_t, N> widen(Pack<std::uint16_t, N> shorts) {
    using Words = Pack<std::int32_t, N>;
    if constexpr (is_native<std::int32_t, N>) {
        return Words(native_widen(shorts.v));
    } else if constexpr (is_native<std::uint16_t, N>) {
        const auto halves = split(shorts.v);
        return {widen<N / 2>(halves.low), widen<N / 2>(halves.high)};
    } else {
        return {widen<N / 2>(shorts.lo), widen<N / 2>(shorts.hi)};
    }
}
template <int N>
CHIARO_INLINE void narrow(Pack<std::int32_t, N> values, std::uint16_t* to) {
    if constexpr (is_native<std::int32_t, N>) {
        store_vector(native_narrow(values.v), to);
    } else {
        narrow<N / 2>(values.lo, to);
        narrow<N / 2>(values.hi, to + N / 2);
    }
}
CHIARO_INLINE Lanes to_float(ShortLanes shorts) { return to_float(widen<16>(shorts)); }
CHIARO_INLINE void store_whole(IntLanes values, std::uint16_t* to) { narrow<16>(values, to); }

}  // namespace CHIARO_ISA
template <>
struct ShortsOf<Lanes> {
    using type = ShortLanes;
};
#endif

template <class F>
CHIARO_INLINE Shorts<F> load_shorts(const std::uint16_t* from) {
    Shorts<F> shorts;
    load(from, shorts);
    return shorts;
}
/// As numbers.
template <class F>
CHIARO_INLINE F load_row(const std::uint16_t* from) {
    return to_float(load_shorts<F>(from));
}
/// Shares in [0, 1] as 65535ths.
template <class F>
CHIARO_INLINE void store_shares(F shares, std::uint16_t* to) {
    store_whole(truncate(shares * F(65535) + F(0.5f)), to);
}

/// Floats, one native vector after the other: a copy of all lanes at once would go through general registers.
template <class F>
CHIARO_INLINE F load_row(const float* from) {
    if constexpr (requires(F f) { f.lo; }) {
        using Half = decltype(F::lo);
        return {load_row<Half>(from), load_row<Half>(from + sizeof(Half) / sizeof(float))};
    } else {
        F lanes;
        __builtin_memcpy(&lanes, from, sizeof lanes);
        return lanes;
    }
}
/// a0 b0 a1 b1 ...
CHIARO_INLINE void load_interleaved(const float* from, float& a, float& b) { a = from[0], b = from[1]; }
#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {
template <int N>
CHIARO_INLINE void load_interleaved(const float* from, Pack<float, N>& a, Pack<float, N>& b) {
    if constexpr (is_native<float, N>) {
        const auto low = load_row<Pack<float, N>>(from).v, high = load_row<Pack<float, N>>(from + N).v;
        [&]<int... i>(std::integer_sequence<int, i...>) CHIARO_INLINE_LAMBDA {
            a = Pack<float, N>(__builtin_shufflevector(low, high, (2 * i)...));
            b = Pack<float, N>(__builtin_shufflevector(low, high, (2 * i + 1)...));
        }
        (std::make_integer_sequence<int, N>());
    } else {
        load_interleaved(from, a.lo, b.lo), load_interleaved(from + N, a.hi, b.hi);
    }
}
}  // namespace CHIARO_ISA
#endif
template <class F>
CHIARO_INLINE void store_row(float* to, F lanes) {
    if constexpr (requires { lanes.lo; }) {
        store_row(to, lanes.lo);
        store_row(to + sizeof lanes.lo / sizeof(float), lanes.hi);
    } else {
        __builtin_memcpy(to, &lanes, sizeof lanes);
    }
}

/// Four and sixteen numbers of one item: vectors where F is sixteen lanes, arrays where F is one.
template <int N>
struct Numbers {
    float at[N];
    Numbers() = default;
    CHIARO_INLINE Numbers(float same) {
        for (float& number : at) number = same;
    }
};
#define CHIARO_NUMBERS(name, expression)                                      \
    template <int N>                                                          \
    CHIARO_INLINE Numbers<N> name(const Numbers<N>& a, const Numbers<N>& b) { \
        Numbers<N> found;                                                     \
        for (int i = 0; i < N; ++i) found.at[i] = expression;                 \
        return found;                                                         \
    }
CHIARO_NUMBERS(operator+, a.at[i] + b.at[i])
CHIARO_NUMBERS(operator-, a.at[i] - b.at[i])
CHIARO_NUMBERS(operator*, a.at[i] * b.at[i])
CHIARO_NUMBERS(min, min(a.at[i], b.at[i]))
CHIARO_NUMBERS(max, max(a.at[i], b.at[i]))
#undef CHIARO_NUMBERS
template <int N>
CHIARO_INLINE Numbers<N> exp2(Numbers<N> x) {
    for (float& number : x.at) number = exp2(number);
    return x;
}
template <int N>
CHIARO_INLINE void load(const float* from, Numbers<N>& to) {
    __builtin_memcpy(to.at, from, sizeof to.at);
}
template <int N, class Byte>
requires(sizeof(Byte) == 1) CHIARO_INLINE void load(const Byte* from, Numbers<N>& to) {
    for (int i = 0; i < N; ++i) to.at[i] = float(from[i]);
}
template <int N>
CHIARO_INLINE void store(const Numbers<N>& from, float* to) {
    __builtin_memcpy(to, from.at, sizeof from.at);
}
/// Of each of four rows the sum, in a fixed order.
CHIARO_INLINE Numbers<4> sums_of(const Numbers<16> (&rows)[4]) {
    Numbers<4> sums;
    for (int k = 0; k < 4; ++k) {
        const float* r = rows[k].at;
        float of[4];
        for (int i = 0; i < 4; ++i) of[i] = (r[i] + r[i + 8]) + (r[i + 4] + r[i + 12]);
        sums.at[k] = (of[0] + of[1]) + (of[2] + of[3]);
    }
    return sums;
}

template <class F>
struct NumbersOf {
    using Four = Numbers<4>;
    using Sixteen = Numbers<16>;
};

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {

template <int N>
CHIARO_INLINE void load(const std::int8_t* from, Pack<float, N>& to) {
    if constexpr (is_native<float, N>)
        to.v = __builtin_convertvector(native_widened(from), typename VectorOf<float, N>::type);
    else
        load(from, to.lo), load(from + N / 2, to.hi);
}
CHIARO_INLINE void load(const float* from, Lanes& to) { to = load_row<Lanes>(from); }
CHIARO_INLINE void store(Lanes from, float* to) { store_row(to, from); }

struct FourLanes {
    __m128 v;
    FourLanes() = default;
    CHIARO_INLINE FourLanes(__m128 vector) : v(vector) {}
    CHIARO_INLINE FourLanes(float same) : v(_mm_set1_ps(same)) {}
};
CHIARO_INLINE FourLanes operator+(FourLanes a, FourLanes b) { return a.v + b.v; }
CHIARO_INLINE FourLanes operator-(FourLanes a, FourLanes b) { return a.v - b.v; }
CHIARO_INLINE FourLanes operator*(FourLanes a, FourLanes b) { return a.v * b.v; }
CHIARO_INLINE FourLanes min(FourLanes a, FourLanes b) { return _mm_min_ps(a.v, b.v); }
CHIARO_INLINE FourLanes max(FourLanes a, FourLanes b) { return _mm_max_ps(a.v, b.v); }
CHIARO_INLINE void load(const float* from, FourLanes& to) { to.v = _mm_loadu_ps(from); }
CHIARO_INLINE void load(const std::uint8_t* from, FourLanes& to) {
    std::int32_t bytes;
    __builtin_memcpy(&bytes, from, sizeof bytes);
    to.v = _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(bytes)));
}
CHIARO_INLINE void store(FourLanes from, float* to) { _mm_storeu_ps(to, from.v); }

/// The halves added up.
template <int N>
CHIARO_INLINE __m128 folded(Pack<float, N> numbers) {
    if constexpr (N == 4) {
        return numbers.v;
    } else if constexpr (is_native<float, N>) {
        Pack<float, N / 2> low, high;
        __builtin_memcpy(&low, &numbers, sizeof low);
        __builtin_memcpy(&high, reinterpret_cast<const char*>(&numbers) + sizeof low, sizeof high);
        return folded(Pack<float, N / 2>(low.v + high.v));
    } else {
        return folded(map<float, N / 2>(
            [](auto u, auto v) __attribute__((always_inline)) { return u + v; }, numbers.lo, numbers.hi));
    }
}
CHIARO_INLINE FourLanes sums_of(const Lanes (&rows)[4]) {
    return _mm_hadd_ps(_mm_hadd_ps(folded(rows[0]), folded(rows[1])), _mm_hadd_ps(folded(rows[2]), folded(rows[3])));
}

}  // namespace CHIARO_ISA
template <>
struct NumbersOf<Lanes> {
    using Four = FourLanes;
    using Sixteen = Lanes;
};
#endif

template <class N, class T>
CHIARO_INLINE N loaded(const T* from) {
    N numbers;
    load(from, numbers);
    return numbers;
}

}  // namespace chiaro::kernel

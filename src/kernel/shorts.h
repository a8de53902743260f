// Two vectors of 16-bit numbers side by side.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

/// use(a[k], b[k]) for k of [first, end), whole sixteens, of vectors that begin at such. A thread of a GPU reads eight
/// numbers at once, or it would wait for each; the CPU's compiler does so by itself.
template <class Use>
CHIARO_INLINE void for_both(const std::int16_t* a, const std::int16_t* b, int first, int end, Use&& use) {
#ifdef __CUDACC__
    struct alignas(16) Eight {
        std::int16_t at[8];
    };
    for (int k = first; k < end; k += 8) {
        const Eight of_a = *reinterpret_cast<const Eight*>(a + k), of_b = *reinterpret_cast<const Eight*>(b + k);
#pragma unroll
        for (int i = 0; i < 8; ++i) use(of_a.at[i], of_b.at[i]);
    }
#else
    for (int k = first; k < end; ++k) use(a[k], b[k]);
#endif
}

/// Σ (x - y)² for each of four vectors y of `count` numbers, a multiple of 16. The sums must fit.
#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {

/// The squares of neighbours, added up.
CHIARO_INLINE __m128i native_squares(__m128i d) { return _mm_madd_epi16(d, d); }
#if defined(__AVX2__)
CHIARO_INLINE __m256i native_squares(__m256i d) { return _mm256_madd_epi16(d, d); }
#endif
#if defined(__AVX512F__)
CHIARO_INLINE __m512i native_squares(__m512i d) { return _mm512_madd_epi16(d, d); }
#endif

/// From number k on, as many as fill whole vectors (V and its Register are as wide); answers where it stopped.
template <class V, class Register, class Words>
CHIARO_INLINE int add_squares(const std::int16_t* x, const std::int16_t* const (&to)[4], int k, int count,
                              Words (&sums)[4]) {
    constexpr int lanes = sizeof(V) / sizeof(std::int16_t);
    const auto load = [&](const std::int16_t* from) CHIARO_INLINE_LAMBDA {
        return load_vector<V>(reinterpret_cast<const std::uint16_t*>(from + k));
    };
    for (; k + lanes <= count; k += lanes) {
        const V here = load(x);
        for (int i = 0; i < 4; ++i) sums[i] += Words(native_squares(Register(here - load(to[i]))));
    }
    return k;
}

// Four at a time: adding up the lanes of one takes as long as thirty of its numbers.
CHIARO_INLINE void square_distances(const std::int16_t* x, const std::int16_t* const (&to)[4], int count,
                                    std::int32_t (&sums)[4]) {
    int k = 0;
#if defined(__AVX2__)
    typedef VectorOf<std::int32_t, 8>::type Words;
    Words all[4] = {};
#if defined(__AVX512F__)
    typedef VectorOf<std::int32_t, 16>::type WideWords;
    WideWords wide[4] = {};
    k = add_squares<VectorOf<std::uint16_t, 32>::type, __m512i>(x, to, k, count, wide);
    for (int i = 0; i < 4; ++i)
        all[i] =
            Words(_mm512_castsi512_si256(__m512i(wide[i]))) + Words(_mm512_extracti64x4_epi64(__m512i(wide[i]), 1));
#endif
    add_squares<NativeShorts16, __m256i>(x, to, k, count, all);
    const __m256i pairs = _mm256_hadd_epi32(_mm256_hadd_epi32(__m256i(all[0]), __m256i(all[1])),
                                            _mm256_hadd_epi32(__m256i(all[2]), __m256i(all[3])));
    const __m128i whole = _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
#else
    typedef VectorOf<std::int32_t, 4>::type Words;
    Words all[4] = {};
    add_squares<NativeShorts8, __m128i>(x, to, k, count, all);
    const __m128i whole = _mm_hadd_epi32(_mm_hadd_epi32(__m128i(all[0]), __m128i(all[1])),
                                         _mm_hadd_epi32(__m128i(all[2]), __m128i(all[3])));
#endif
    _mm_storeu_si128(reinterpret_cast<__m128i*>(sums), whole);
}

}  // namespace CHIARO_ISA
#else
CHIARO_INLINE void square_distances(const std::int16_t* x, const std::int16_t* const (&to)[4], int count,
                                    std::int32_t (&sums)[4]) {
    for (int i = 0; i < 4; ++i) {
        sums[i] = 0;
        for_both(x, to[i], 0, count, [&](std::int16_t u, std::int16_t v) CHIARO_INLINE_LAMBDA {
            const std::int16_t d = std::int16_t(u - v);
            sums[i] += std::int32_t(d) * std::int32_t(d);
        });
    }
}
#endif

}  // namespace chiaro::kernel

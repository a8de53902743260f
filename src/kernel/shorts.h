// Two vectors of 16-bit numbers side by side.
#pragma once
#include "kernel/lanes.h"

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

// Four at a time: adding up the lanes of one takes as long as thirty of its numbers.
CHIARO_INLINE void square_distances(const std::int16_t* x, const std::int16_t* const (&to)[4], int count,
                                    std::int32_t (&sums)[4]) {
    int k = 0;
#if defined(__AVX512F__)
    const auto load_wide = [&](const std::int16_t* from) CHIARO_INLINE_LAMBDA { return _mm512_loadu_si512(from + k); };
    __m512i wide[4] = {};
    for (; k + 32 <= count; k += 32) {
        const __m512i here = load_wide(x);
        for (int i = 0; i < 4; ++i) {
            const __m512i d = _mm512_sub_epi16(here, load_wide(to[i]));
            wide[i] = _mm512_add_epi32(wide[i], _mm512_madd_epi16(d, d));
        }
    }
#endif
#if defined(__AVX2__)
    const auto load = [&](const std::int16_t* from) CHIARO_INLINE_LAMBDA {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + k));
    };
    __m256i all[4] = {};
#if defined(__AVX512F__)
    for (int i = 0; i < 4; ++i)
        all[i] = _mm256_add_epi32(_mm512_castsi512_si256(wide[i]), _mm512_extracti64x4_epi64(wide[i], 1));
#endif
    for (; k < count; k += 16) {
        const __m256i here = load(x);
        for (int i = 0; i < 4; ++i) {
            const __m256i d = _mm256_sub_epi16(here, load(to[i]));
            all[i] = _mm256_add_epi32(all[i], _mm256_madd_epi16(d, d));
        }
    }
    const __m256i pairs = _mm256_hadd_epi32(_mm256_hadd_epi32(all[0], all[1]), _mm256_hadd_epi32(all[2], all[3]));
    const __m128i whole = _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
#else
    const auto load = [&](const std::int16_t* from)
                          CHIARO_INLINE_LAMBDA { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + k)); };
    __m128i all[4] = {};
    for (; k < count; k += 8) {
        const __m128i here = load(x);
        for (int i = 0; i < 4; ++i) {
            const __m128i d = _mm_sub_epi16(here, load(to[i]));
            all[i] = _mm_add_epi32(all[i], _mm_madd_epi16(d, d));
        }
    }
    const __m128i whole = _mm_hadd_epi32(_mm_hadd_epi32(all[0], all[1]), _mm_hadd_epi32(all[2], all[3]));
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

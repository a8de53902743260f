// Reading memory at one index per lane. Hardware gathers are microcoded; scalar loads put into place are faster, and one
// load brings the neighbours along x together: two voxels (value) or four (value and gradient).
// An index is unsigned 32 bit: up to 2^32 elements.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

template <class F> struct Two {
    F a, b;
};
template <class F> struct Four {
    F a, b, c, d;
};

template <class V> CHIARO_INLINE Two<float> gather_two(const V* p, std::int32_t index) {
    p += std::uint32_t(index);
    return {float(p[0]), float(p[1])};
}
template <class V> CHIARO_INLINE Four<float> gather_four(const V* p, std::int32_t index) {
    p += std::uint32_t(index);
    return {float(p[0]), float(p[1]), float(p[2]), float(p[3])};
}
CHIARO_INLINE std::int32_t gather_byte(const std::uint8_t* p, std::int32_t index) { return p[std::uint32_t(index)]; }

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {

/// The indices in memory, where scalar address arithmetic finds them.
struct Indices {
    alignas(64) std::uint32_t at[16];
    CHIARO_INLINE explicit Indices(IntLanes index) { __builtin_memcpy(at, &index, sizeof at); }
};

template <class Word> CHIARO_INLINE Word load_unaligned(const void* p) {
    Word word;
    __builtin_memcpy(&word, p, sizeof word);
    return word;
}

/// Four 32-bit words from four addresses.
template <class V> CHIARO_INLINE __m128i words4(const V* p, const std::uint32_t* at) {
    __m128i v = _mm_cvtsi32_si128(load_unaligned<std::int32_t>(p + at[0]));
    v = _mm_insert_epi32(v, load_unaligned<std::int32_t>(p + at[1]), 1);
    v = _mm_insert_epi32(v, load_unaligned<std::int32_t>(p + at[2]), 2);
    return _mm_insert_epi32(v, load_unaligned<std::int32_t>(p + at[3]), 3);
}

/// One 32-bit word per lane.
template <class V> CHIARO_INLINE IntLanes gather_words(const V* p, const Indices& i) {
    const __m128i a = words4(p, i.at), b = words4(p, i.at + 4), c = words4(p, i.at + 8), d = words4(p, i.at + 12);
#if defined(__AVX512F__)
    const __m256i low = _mm256_inserti128_si256(_mm256_castsi128_si256(a), b, 1), high = _mm256_inserti128_si256(_mm256_castsi128_si256(c), d, 1);
    return IntLanes(NativeInt(_mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1)));
#elif defined(__AVX2__)
    return {Pack<std::int32_t, 8>(NativeInt(_mm256_inserti128_si256(_mm256_castsi128_si256(a), b, 1))),
            Pack<std::int32_t, 8>(NativeInt(_mm256_inserti128_si256(_mm256_castsi128_si256(c), d, 1)))};
#else
    return {{Pack<std::int32_t, 4>(NativeInt(a)), Pack<std::int32_t, 4>(NativeInt(b))}, {Pack<std::int32_t, 4>(NativeInt(c)), Pack<std::int32_t, 4>(NativeInt(d))}};
#endif
}

/// Eight 16-bit words from eight addresses.
template <class V> CHIARO_INLINE __m128i halves8(const V* p, const std::uint32_t* at) {
    __m128i v = _mm_cvtsi32_si128(load_unaligned<std::uint16_t>(p + at[0]));
    v = _mm_insert_epi16(v, load_unaligned<std::uint16_t>(p + at[1]), 1);
    v = _mm_insert_epi16(v, load_unaligned<std::uint16_t>(p + at[2]), 2);
    v = _mm_insert_epi16(v, load_unaligned<std::uint16_t>(p + at[3]), 3);
    v = _mm_insert_epi16(v, load_unaligned<std::uint16_t>(p + at[4]), 4);
    v = _mm_insert_epi16(v, load_unaligned<std::uint16_t>(p + at[5]), 5);
    v = _mm_insert_epi16(v, load_unaligned<std::uint16_t>(p + at[6]), 6);
    return _mm_insert_epi16(v, load_unaligned<std::uint16_t>(p + at[7]), 7);
}

/// One 16-bit word per lane, zero-extended.
template <class V> CHIARO_INLINE IntLanes gather_halves(const V* p, const Indices& i) {
    const __m128i a = halves8(p, i.at), b = halves8(p, i.at + 8);
#if defined(__AVX512F__)
    return IntLanes(NativeInt(_mm512_cvtepu16_epi32(_mm256_inserti128_si256(_mm256_castsi128_si256(a), b, 1))));
#elif defined(__AVX2__)
    return {Pack<std::int32_t, 8>(NativeInt(_mm256_cvtepu16_epi32(a))), Pack<std::int32_t, 8>(NativeInt(_mm256_cvtepu16_epi32(b)))};
#else
    return {{Pack<std::int32_t, 4>(NativeInt(_mm_cvtepu16_epi32(a))), Pack<std::int32_t, 4>(NativeInt(_mm_cvtepu16_epi32(_mm_srli_si128(a, 8))))},
            {Pack<std::int32_t, 4>(NativeInt(_mm_cvtepu16_epi32(b))), Pack<std::int32_t, 4>(NativeInt(_mm_cvtepu16_epi32(_mm_srli_si128(b, 8))))}};
#endif
}

/// The byte or half at `shift` bits of each word. Words may be negative: the shift is arithmetic, the mask follows it.
template <int shift, int bits> CHIARO_INLINE Lanes field(IntLanes word) {
    return to_float((word >> IntLanes(shift)) & IntLanes((1 << bits) - 1));
}

CHIARO_INLINE Two<Lanes> gather_two(const std::uint8_t* p, const Indices& i) {
    const IntLanes word = gather_halves(p, i);
    return {field<0, 8>(word), to_float(word >> IntLanes(8))};
}
CHIARO_INLINE Two<Lanes> gather_two(const std::uint16_t* p, const Indices& i) {
    const IntLanes word = gather_words(p, i);
    return {field<0, 16>(word), field<16, 16>(word)};
}
CHIARO_INLINE Two<Lanes> gather_two(const float* p, const Indices& i) {
    return {float_of(gather_words(p, i)), float_of(gather_words(p + 1, i))};
}
CHIARO_INLINE Four<Lanes> gather_four(const std::uint8_t* p, const Indices& i) {
    const IntLanes word = gather_words(p, i);
    return {field<0, 8>(word), field<8, 8>(word), field<16, 8>(word), field<24, 8>(word)};
}
template <class V> CHIARO_INLINE Four<Lanes> gather_four(const V* p, const Indices& i) {
    const Two<Lanes> ab = gather_two(p, i), cd = gather_two(p + 2, i);
    return {ab.a, ab.b, cd.a, cd.b};
}
CHIARO_INLINE IntLanes gather_byte(const std::uint8_t* p, IntLanes index) {
    const Indices i(index);
    // Two bytes a load; the table ends with one spare byte.
    return gather_halves(p, i) & IntLanes(0xff);
}

}  // namespace CHIARO_ISA
#endif

/// What gathers take as an index: for a SIMD type the indices are spilled once and serve several loads.
template <class F> struct GatherIndex;
template <> struct GatherIndex<float> {
    using type = std::int32_t;
};
#ifdef CHIARO_SIMD
template <> struct GatherIndex<Lanes> {
    using type = Indices;
};
#endif

}  // namespace chiaro::kernel

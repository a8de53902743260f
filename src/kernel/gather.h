// Reading memory at one index per lane. One load brings the neighbours along x together: two voxels (value) or four
// (value and gradient). Loads are put into place one by one, which is faster than most processors' own gathers; those
// that gather faster (Isa::x86_64_v4_gather) do. An index is unsigned 32 bit: up to 2^32 elements.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

template <class F>
struct Two {
    F a, b;
};
template <class F>
struct Four {
    F a, b, c, d;
};

/// The same load at four fixed distances (in voxels) from the lane's address: one address serves four loads.
struct Distances {
    std::int32_t a, b, c, d;
};

template <class V>
CHIARO_INLINE Two<float> load_two(const V* p) {
    return {float(p[0]), float(p[1])};
}
template <class V>
CHIARO_INLINE Four<float> load_four(const V* p) {
    return {float(p[0]), float(p[1]), float(p[2]), float(p[3])};
}

/// Voxels 0 and 1 at four distances.
template <class V>
CHIARO_INLINE Four<Two<float>> gather_two(const V* p, std::int32_t index, Distances at) {
    p += std::uint32_t(index);
    return {load_two(p + at.a), load_two(p + at.b), load_two(p + at.c), load_two(p + at.d)};
}
/// Voxels 0 to 3 at four distances.
template <class V>
CHIARO_INLINE Four<Four<float>> gather_four(const V* p, std::int32_t index, Distances at) {
    p += std::uint32_t(index);
    return {load_four(p + at.a), load_four(p + at.b), load_four(p + at.c), load_four(p + at.d)};
}
/// The four bytes of a word, the lowest first, at four distances.
CHIARO_INLINE Four<Four<float>> gather_bytes(const std::uint32_t* p, std::int32_t index, Distances at) {
    p += std::uint32_t(index);
    const auto bytes = [](std::uint32_t w) CHIARO_INLINE_LAMBDA {
        return Four<float>{float(w & 255), float(w >> 8 & 255), float(w >> 16 & 255), float(w >> 24)};
    };
    return {bytes(p[at.a]), bytes(p[at.b]), bytes(p[at.c]), bytes(p[at.d])};
}
/// For a byte a word may be read: so many lie behind the last one.
inline constexpr std::size_t spare_bytes = 3;
CHIARO_INLINE std::int32_t gather_byte(const std::uint8_t* p, std::int32_t index) { return p[std::uint32_t(index)]; }
CHIARO_INLINE std::int32_t gather_word(const std::uint32_t* p, std::int32_t index) {
    return std::int32_t(p[std::uint32_t(index)]);
}

CHIARO_INLINE float gather_float(const float* p, std::int32_t index) { return p[std::uint32_t(index)]; }

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {

#if defined(CHIARO_HARDWARE_GATHER)
/// Hardware takes indices as signed: less 2^31, from the middle of what they may reach.
struct Indices {
    __m512i at;
    CHIARO_INLINE explicit Indices(IntLanes index)
        : at(_mm512_xor_si512(__m512i(index.v), _mm512_set1_epi32(INT32_MIN))) {}
};

template <class V>
CHIARO_INLINE const void* middle_of(const V* p) {
    return reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(p) + (sizeof(V) << 31));
}
template <class V>
CHIARO_INLINE IntLanes gather_words(const V* p, const Indices& i) {
    return IntLanes(NativeInt(_mm512_i32gather_epi32(i.at, middle_of(p), sizeof(V))));
}
/// One 32-bit word per lane, at four distances.
template <class V>
CHIARO_INLINE Four<IntLanes> gather_words(const V* p, const Indices& i, Distances at) {
    return {gather_words(p + at.a, i), gather_words(p + at.b, i), gather_words(p + at.c, i), gather_words(p + at.d, i)};
}
/// One 16-bit word per lane, zero-extended, at four distances. Reads two bytes beyond it: within a brick.
template <class V>
CHIARO_INLINE Four<IntLanes> gather_halves(const V* p, const Indices& i, Distances at) {
    const Four<IntLanes> w = gather_words(p, i, at);
    const IntLanes low(0xffff);
    return {w.a & low, w.b & low, w.c & low, w.d & low};
}
/// Two 32-bit words per lane, side by side: eight lanes to a gather.
template <int bytes>
CHIARO_INLINE Two<IntLanes> gather_pairs_at(const void* p, __m512i index) {
    const __m512i low = _mm512_i32gather_epi64(_mm512_castsi512_si256(index), p, bytes),
                  high = _mm512_i32gather_epi64(_mm512_extracti64x4_epi64(index, 1), p, bytes),
                  even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0),
                  odd = _mm512_set_epi32(31, 29, 27, 25, 23, 21, 19, 17, 15, 13, 11, 9, 7, 5, 3, 1);
    return {IntLanes(NativeInt(_mm512_permutex2var_epi32(low, even, high))),
            IntLanes(NativeInt(_mm512_permutex2var_epi32(low, odd, high)))};
}
template <class V>
CHIARO_INLINE Four<Two<IntLanes>> gather_pairs(const V* p, const Indices& i, Distances at) {
    const auto pairs = [&](int distance)
                           CHIARO_INLINE_LAMBDA { return gather_pairs_at<sizeof(V)>(middle_of(p + distance), i.at); };
    return {pairs(at.a), pairs(at.b), pairs(at.c), pairs(at.d)};
}
CHIARO_INLINE IntLanes gather_byte(const std::uint8_t* p, const Indices& i) {
    return gather_words(p, i) & IntLanes(255);
}
template <class V>
CHIARO_INLINE IntLanes gather_word(const V* p, const Indices& i) {
    return gather_words(p, i);
}
#else
/// The indices in memory, where scalar address arithmetic finds them. The empty statement keeps the compiler from
/// picking them out of the vector register again, which takes two instructions each.
struct Indices {
    alignas(64) std::uint32_t at[16];
    CHIARO_INLINE explicit Indices(IntLanes index) {
        __builtin_memcpy(at, &index, sizeof at);
        asm("" : "+m"(at));
    }
};

struct FourVectors {
    __m128i a, b, c, d;
};

template <class Word>
CHIARO_INLINE Word load_unaligned(const void* p) {
    Word word;
    __builtin_memcpy(&word, p, sizeof word);
    return word;
}

template <int lane>
CHIARO_INLINE __m128i insert_word(__m128i v, const void* p) {
    return _mm_insert_epi32(v, load_unaligned<std::int32_t>(p), lane);
}
template <int lane>
CHIARO_INLINE __m128i insert_half(__m128i v, const void* p) {
    return _mm_insert_epi16(v, load_unaligned<std::uint16_t>(p), lane);
}

/// 32-bit words of four lanes at four distances.
template <class V>
CHIARO_INLINE FourVectors words4(const V* voxels, const std::uint32_t* index, Distances at) {
    const V* p = voxels + index[0];
    FourVectors w{_mm_cvtsi32_si128(load_unaligned<std::int32_t>(p + at.a)),
                  _mm_cvtsi32_si128(load_unaligned<std::int32_t>(p + at.b)),
                  _mm_cvtsi32_si128(load_unaligned<std::int32_t>(p + at.c)),
                  _mm_cvtsi32_si128(load_unaligned<std::int32_t>(p + at.d))};
    p = voxels + index[1];
    w = {insert_word<1>(w.a, p + at.a), insert_word<1>(w.b, p + at.b), insert_word<1>(w.c, p + at.c),
         insert_word<1>(w.d, p + at.d)};
    p = voxels + index[2];
    w = {insert_word<2>(w.a, p + at.a), insert_word<2>(w.b, p + at.b), insert_word<2>(w.c, p + at.c),
         insert_word<2>(w.d, p + at.d)};
    p = voxels + index[3];
    return {insert_word<3>(w.a, p + at.a), insert_word<3>(w.b, p + at.b), insert_word<3>(w.c, p + at.c),
            insert_word<3>(w.d, p + at.d)};
}

template <int lane, class V>
CHIARO_INLINE void insert_halves(FourVectors& w, const V* p, Distances at) {
    w = {insert_half<lane>(w.a, p + at.a), insert_half<lane>(w.b, p + at.b), insert_half<lane>(w.c, p + at.c),
         insert_half<lane>(w.d, p + at.d)};
}

/// 16-bit words of eight lanes at four distances.
template <class V>
CHIARO_INLINE FourVectors halves8(const V* voxels, const std::uint32_t* index, Distances at) {
    const V* p = voxels + index[0];
    FourVectors w{_mm_cvtsi32_si128(load_unaligned<std::uint16_t>(p + at.a)),
                  _mm_cvtsi32_si128(load_unaligned<std::uint16_t>(p + at.b)),
                  _mm_cvtsi32_si128(load_unaligned<std::uint16_t>(p + at.c)),
                  _mm_cvtsi32_si128(load_unaligned<std::uint16_t>(p + at.d))};
    insert_halves<1>(w, voxels + index[1], at);
    insert_halves<2>(w, voxels + index[2], at);
    insert_halves<3>(w, voxels + index[3], at);
    insert_halves<4>(w, voxels + index[4], at);
    insert_halves<5>(w, voxels + index[5], at);
    insert_halves<6>(w, voxels + index[6], at);
    insert_halves<7>(w, voxels + index[7], at);
    return w;
}

/// Four vectors of four words, or two of eight halves, to sixteen lanes.
CHIARO_INLINE IntLanes join_words(__m128i a, __m128i b, __m128i c, __m128i d) {
#if defined(__AVX512F__)
    const __m256i low = _mm256_inserti128_si256(_mm256_castsi128_si256(a), b, 1),
                  high = _mm256_inserti128_si256(_mm256_castsi128_si256(c), d, 1);
    return IntLanes(NativeInt(_mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1)));
#elif defined(__AVX2__)
    return {Pack<std::int32_t, 8>(NativeInt(_mm256_inserti128_si256(_mm256_castsi128_si256(a), b, 1))),
            Pack<std::int32_t, 8>(NativeInt(_mm256_inserti128_si256(_mm256_castsi128_si256(c), d, 1)))};
#else
    return {{Pack<std::int32_t, 4>(NativeInt(a)), Pack<std::int32_t, 4>(NativeInt(b))},
            {Pack<std::int32_t, 4>(NativeInt(c)), Pack<std::int32_t, 4>(NativeInt(d))}};
#endif
}
CHIARO_INLINE IntLanes join_halves(__m128i a, __m128i b) {
#if defined(__AVX512F__)
    return IntLanes(NativeInt(_mm512_cvtepu16_epi32(_mm256_inserti128_si256(_mm256_castsi128_si256(a), b, 1))));
#elif defined(__AVX2__)
    return {Pack<std::int32_t, 8>(NativeInt(_mm256_cvtepu16_epi32(a))),
            Pack<std::int32_t, 8>(NativeInt(_mm256_cvtepu16_epi32(b)))};
#else
    return join_words(_mm_cvtepu16_epi32(a), _mm_cvtepu16_epi32(_mm_srli_si128(a, 8)), _mm_cvtepu16_epi32(b),
                      _mm_cvtepu16_epi32(_mm_srli_si128(b, 8)));
#endif
}

/// One 32-bit word per lane, at four distances.
template <class V>
CHIARO_INLINE Four<IntLanes> gather_words(const V* p, const Indices& i, Distances at) {
    const FourVectors r = words4(p, i.at, at), s = words4(p, i.at + 4, at), t = words4(p, i.at + 8, at),
                      u = words4(p, i.at + 12, at);
    return {join_words(r.a, s.a, t.a, u.a), join_words(r.b, s.b, t.b, u.b), join_words(r.c, s.c, t.c, u.c),
            join_words(r.d, s.d, t.d, u.d)};
}
/// One 16-bit word per lane, zero-extended, at four distances.
template <class V>
CHIARO_INLINE Four<IntLanes> gather_halves(const V* p, const Indices& i, Distances at) {
    const FourVectors r = halves8(p, i.at, at), s = halves8(p, i.at + 8, at);
    return {join_halves(r.a, s.a), join_halves(r.b, s.b), join_halves(r.c, s.c), join_halves(r.d, s.d)};
}

/// Two 32-bit words per lane, side by side.
template <class V>
CHIARO_INLINE Four<Two<IntLanes>> gather_pairs(const V* p, const Indices& i, Distances at) {
    constexpr int word = sizeof(std::int32_t) / sizeof(V);
    const Four<IntLanes> v = gather_words(p, i, at), w = gather_words(p + word, i, at);
    return {{v.a, w.a}, {v.b, w.b}, {v.c, w.c}, {v.d, w.d}};
}
CHIARO_INLINE IntLanes gather_byte(const std::uint8_t* p, const Indices& i) {
    const auto bytes4 = [&](int lane) CHIARO_INLINE_LAMBDA {
        __m128i v = _mm_cvtsi32_si128(p[i.at[lane]]);
        v = _mm_insert_epi8(v, p[i.at[lane + 1]], 4);
        v = _mm_insert_epi8(v, p[i.at[lane + 2]], 8);
        return _mm_insert_epi8(v, p[i.at[lane + 3]], 12);
    };
    return join_words(bytes4(0), bytes4(4), bytes4(8), bytes4(12));
}
template <class V>
CHIARO_INLINE IntLanes gather_word(const V* p, const Indices& i) {
    return gather_words(p, i, {0, 0, 0, 0}).a;
}
#endif

/// The byte or half at `shift` bits of each word. Words may be negative: the shift is arithmetic, the mask follows it.
template <int shift, int bits>
CHIARO_INLINE Lanes bit_field(IntLanes word) {
    return to_float((word >> IntLanes(shift)) & IntLanes((1 << bits) - 1));
}
CHIARO_INLINE Two<Lanes> split_bytes(IntLanes half) { return {bit_field<0, 8>(half), to_float(half >> IntLanes(8))}; }
CHIARO_INLINE Two<Lanes> split_halves(IntLanes word) { return {bit_field<0, 16>(word), bit_field<16, 16>(word)}; }
template <int byte>
CHIARO_INLINE Lanes byte_of(IntLanes word) {
#if defined(__AVX512F__)
    constexpr int none = int(0x80808000);  // of the three bytes above: 0
    const __m512i from = _mm512_set4_epi32(none + 12 + byte, none + 8 + byte, none + 4 + byte, none + byte);
    return to_float(IntLanes(NativeInt(_mm512_shuffle_epi8(__m512i(word.v), from))));
#else
    return bit_field<8 * byte, 8>(word);
#endif
}
CHIARO_INLINE Four<Lanes> split_four(IntLanes word) {
    return {bit_field<0, 8>(word), byte_of<1>(word), byte_of<2>(word), byte_of<3>(word)};
}

CHIARO_INLINE Four<Two<Lanes>> gather_two(const std::uint8_t* p, const Indices& i, Distances at) {
    const Four<IntLanes> w = gather_halves(p, i, at);
    return {split_bytes(w.a), split_bytes(w.b), split_bytes(w.c), split_bytes(w.d)};
}
CHIARO_INLINE Four<Two<Lanes>> gather_two(const std::uint16_t* p, const Indices& i, Distances at) {
    const Four<IntLanes> w = gather_words(p, i, at);
    return {split_halves(w.a), split_halves(w.b), split_halves(w.c), split_halves(w.d)};
}
CHIARO_INLINE Two<Lanes> floats_of(Two<IntLanes> words) { return {float_of(words.a), float_of(words.b)}; }
CHIARO_INLINE Four<Two<Lanes>> gather_two(const float* p, const Indices& i, Distances at) {
    const Four<Two<IntLanes>> w = gather_pairs(p, i, at);
    return {floats_of(w.a), floats_of(w.b), floats_of(w.c), floats_of(w.d)};
}
CHIARO_INLINE Four<Four<Lanes>> gather_four(const std::uint8_t* p, const Indices& i, Distances at) {
    const Four<IntLanes> w = gather_words(p, i, at);
    return {split_four(w.a), split_four(w.b), split_four(w.c), split_four(w.d)};
}
CHIARO_INLINE Four<Four<Lanes>> gather_bytes(const std::uint32_t* p, const Indices& i, Distances at) {
    const Four<IntLanes> w = gather_words(p, i, at);
    return {split_four(w.a), split_four(w.b), split_four(w.c), split_four(w.d)};
}
CHIARO_INLINE Four<Lanes> split_pair(Two<IntLanes> words) {
    const Two<Lanes> first = split_halves(words.a), second = split_halves(words.b);
    return {first.a, first.b, second.a, second.b};
}
CHIARO_INLINE Four<Four<Lanes>> gather_four(const std::uint16_t* p, const Indices& i, Distances at) {
    const Four<Two<IntLanes>> w = gather_pairs(p, i, at);
    return {split_pair(w.a), split_pair(w.b), split_pair(w.c), split_pair(w.d)};
}
CHIARO_INLINE Four<Four<Lanes>> gather_four(const float* p, const Indices& i, Distances at) {
    const Four<Two<Lanes>> v = gather_two(p, i, at), w = gather_two(p + 2, i, at);
    return {{v.a.a, v.a.b, w.a.a, w.a.b},
            {v.b.a, v.b.b, w.b.a, w.b.b},
            {v.c.a, v.c.b, w.c.a, w.c.b},
            {v.d.a, v.d.b, w.d.a, w.d.b}};
}

CHIARO_INLINE IntLanes gather_byte(const std::uint8_t* p, IntLanes index) { return gather_byte(p, Indices(index)); }

CHIARO_INLINE Lanes gather_float(const float* p, IntLanes index) { return float_of(gather_word(p, Indices(index))); }

}  // namespace CHIARO_ISA
#endif

/// What gathers take as an index: for a SIMD type the indices are made ready once and serve several loads.
template <class F>
struct GatherIndex;
template <>
struct GatherIndex<float> {
    using type = std::int32_t;
};
#ifdef CHIARO_SIMD
template <>
struct GatherIndex<Lanes> {
    using type = Indices;
};
#endif

}  // namespace chiaro::kernel

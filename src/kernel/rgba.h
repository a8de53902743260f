// Colours of a pack of pixels. The layout is the lane type's own: the scalar side holds one RGBA; sixteen lanes are
// four vectors of four pixels × RGBA, so that a table entry is one 16-byte load and compositing needs no transposition
// (+40 % against four planes). In-lane shuffles only: vector i holds the pixels i, 4+i, 8+i, 12+i. Where the processor
// gathers a channel of sixteen entries at a time (Isa::x86_64_v4_gather) they are four planes.
#pragma once
#include "kernel/gather.h"
#include "kernel/lanes.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

/// Premultiplied colour and opacity; one table entry or one pixel.
struct alignas(16) Rgba {
    float r, g, b, a;
};

template <class F>
struct RgbaOf;
template <>
struct RgbaOf<float> {
    using type = Rgba;
};
template <class F>
using RgbaLanes = typename RgbaOf<F>::type;

CHIARO_INLINE Rgba load_rgba(const Rgba* table, std::int32_t index) { return table[index]; }
CHIARO_INLINE Rgba rgba_of(Vec3<float> c, float alpha) { return {c.x, c.y, c.z, alpha}; }

/// Of one pixel, or channel by channel of several.
template <class C>
concept ByChannel = requires(C c) {
    c.r;
};
template <ByChannel C>
CHIARO_INLINE auto alpha_of(const C& c) {
    return c.a;
}
template <ByChannel C>
CHIARO_INLINE auto colour_of(const C& c) {
    return Vec3<decltype(c.r)>{c.r, c.g, c.b};
}
/// sum + weight * c
template <ByChannel C, class F>
CHIARO_INLINE C accumulate(const C& sum, F weight, const C& c) {
    return {mad(weight, c.r, sum.r), mad(weight, c.g, sum.g), mad(weight, c.b, sum.b), mad(weight, c.a, sum.a)};
}
template <ByChannel C, class F>
CHIARO_INLINE C scale(const C& c, F s) {
    return {s * c.r, s * c.g, s * c.b, s * c.a};
}
/// Colour times `diffuse` plus opacity times `specular`; the opacity stays.
template <ByChannel C, class F>
CHIARO_INLINE C light_up(const C& c, Vec3<F> diffuse, Vec3<F> specular) {
    return {mad(c.r, diffuse.x, c.a * specular.x), mad(c.g, diffuse.y, c.a * specular.y),
            mad(c.b, diffuse.z, c.a * specular.z), c.a};
}
/// The same of factors for each channel.
template <ByChannel C>
CHIARO_INLINE C light_up(const C& c, const C& diffuse, const C& specular) {
    return {mad(c.r, diffuse.r, c.a * specular.r), mad(c.g, diffuse.g, c.a * specular.g),
            mad(c.b, diffuse.b, c.a * specular.b), mad(c.a, diffuse.a, c.a * specular.a)};
}
template <ByChannel C>
CHIARO_INLINE void zero(C& c) {
    c.r = c.g = c.b = c.a = decltype(c.r)(0);
}
/// Writes the pixels of a 1 × 1 block.
CHIARO_INLINE void store_block(Rgba c, Rgba* first, int /*row_length*/, bool inside) {
    if (inside) *first = c;
}

#ifdef CHIARO_SIMD
inline namespace CHIARO_ISA {

/// Four pixels a vector.
struct RgbaQuads {
    Lanes q0, q1, q2, q3;
};

/// In each group of four lanes: {a[i], a[j], b[k], b[l]}.
template <int i, int j, int k, int l>
CHIARO_INLINE Lanes shuffle(Lanes a, Lanes b) {
    return map<float, 16>(
        [](auto x, auto y)
            __attribute__((always_inline)) { return native_shuffle<i | j << 2 | k << 4 | l << 6>(x, y); },
        a, b);
}
template <int i>
CHIARO_INLINE Lanes spread(Lanes a) {
    return shuffle<i, i, i, i>(a, a);
}

/// Four planes to four pixels a vector: a 4 × 4 transposition in each group of four lanes.
CHIARO_INLINE RgbaQuads transpose(Lanes r, Lanes g, Lanes b, Lanes a) {
    const Lanes rg01 = shuffle<0, 1, 0, 1>(r, g), rg23 = shuffle<2, 3, 2, 3>(r, g);
    const Lanes ba01 = shuffle<0, 1, 0, 1>(b, a), ba23 = shuffle<2, 3, 2, 3>(b, a);
    return {shuffle<0, 2, 0, 2>(rg01, ba01), shuffle<1, 3, 1, 3>(rg01, ba01), shuffle<0, 2, 0, 2>(rg23, ba23),
            shuffle<1, 3, 1, 3>(rg23, ba23)};
}

#if defined(CHIARO_HARDWARE_GATHER)
struct RgbaPack {
    Lanes r, g, b, a;
};
CHIARO_INLINE RgbaPack rgba_of(Vec3<Lanes> c, Lanes alpha) { return {c.x, c.y, c.z, alpha}; }
CHIARO_INLINE RgbaQuads quads_of(const RgbaPack& c) { return transpose(c.r, c.g, c.b, c.a); }

/// Of tables of at most 2^30 entries. Half an entry at a time: channel by channel an unshaded fog takes a quarter
/// longer.
CHIARO_INLINE RgbaPack load_rgba(const Rgba* table, IntLanes index) {
    static_assert(sizeof(Rgba) == 16);
    const auto half = __m512i((index + index).v);
    const Two<Lanes> rg = floats_of(gather_pairs_at<8>(&table->r, half)),
                     ba = floats_of(gather_pairs_at<8>(&table->b, half));
    return {rg.a, rg.b, ba.a, ba.b};
}
#else
using RgbaPack = RgbaQuads;
CHIARO_INLINE const RgbaQuads& quads_of(const RgbaPack& c) { return c; }

/// One channel of all sixteen. ({a[2], b[2], a[3], b[3]} and so on would need two instructions; this needs three.)
template <int i>
CHIARO_INLINE Lanes channel_of(const RgbaPack& c) {
    return shuffle<0, 2, 0, 2>(shuffle<i, i, i, i>(c.q0, c.q1), shuffle<i, i, i, i>(c.q2, c.q3));
}
CHIARO_INLINE Lanes alpha_of(const RgbaPack& c) { return channel_of<3>(c); }
CHIARO_INLINE Vec3<Lanes> colour_of(const RgbaPack& c) {
    return {channel_of<0>(c), channel_of<1>(c), channel_of<2>(c)};
}
CHIARO_INLINE RgbaPack scale(const RgbaPack& c, Lanes s) {
    return {c.q0 * spread<0>(s), c.q1 * spread<1>(s), c.q2 * spread<2>(s), c.q3 * spread<3>(s)};
}
CHIARO_INLINE RgbaPack accumulate(const RgbaPack& sum, Lanes weight, const RgbaPack& c) {
    return {mad(spread<0>(weight), c.q0, sum.q0), mad(spread<1>(weight), c.q1, sum.q1),
            mad(spread<2>(weight), c.q2, sum.q2), mad(spread<3>(weight), c.q3, sum.q3)};
}
CHIARO_INLINE RgbaPack rgba_of(Vec3<Lanes> c, Lanes alpha) { return transpose(c.x, c.y, c.z, alpha); }
CHIARO_INLINE RgbaPack light_up(const RgbaPack& c, const RgbaPack& d, const RgbaPack& s) {
    return {mad(c.q0, d.q0, shuffle<3, 3, 3, 3>(c.q0, c.q0) * s.q0),
            mad(c.q1, d.q1, shuffle<3, 3, 3, 3>(c.q1, c.q1) * s.q1),
            mad(c.q2, d.q2, shuffle<3, 3, 3, 3>(c.q2, c.q2) * s.q2),
            mad(c.q3, d.q3, shuffle<3, 3, 3, 3>(c.q3, c.q3) * s.q3)};
}
CHIARO_INLINE RgbaPack light_up(const RgbaPack& c, Vec3<Lanes> diffuse, Vec3<Lanes> specular) {
    return light_up(c, rgba_of(diffuse, Lanes(1)), rgba_of(specular, Lanes(0)));
}
CHIARO_INLINE void zero(RgbaPack& c) { c = {Lanes(0), Lanes(0), Lanes(0), Lanes(0)}; }

/// Entries for the lanes first, first + 4, first + 8, first + 12.
CHIARO_INLINE Lanes load_quad(const Rgba* table, const std::uint32_t* index) {
    const auto entry = [&](int lane) __attribute__((always_inline)) { return _mm_load_ps(&table[index[lane]].r); };
#if defined(__AVX512F__)
    return Lanes(_mm512_insertf32x4(
        _mm512_insertf32x4(_mm512_insertf32x4(_mm512_castps128_ps512(entry(0)), entry(4), 1), entry(8), 2), entry(12),
        3));
#elif defined(__AVX2__)
    const auto pair = [&](int lane) __attribute__((always_inline)) {
        return Pack<float, 8>(_mm256_insertf128_ps(_mm256_castps128_ps256(entry(lane)), entry(lane + 4), 1));
    };
    return {pair(0), pair(8)};
#else
    return {{Pack<float, 4>(entry(0)), Pack<float, 4>(entry(4))},
            {Pack<float, 4>(entry(8)), Pack<float, 4>(entry(12))}};
#endif
}
CHIARO_INLINE RgbaPack load_rgba(const Rgba* table, IntLanes index) {
    const Indices i(index);
    return {load_quad(table, i.at), load_quad(table, i.at + 1), load_quad(table, i.at + 2), load_quad(table, i.at + 3)};
}
#endif

/// Writes the 4 × 4 block of pixels whose first is `first`; lane 4 j + i is row j, column i.
CHIARO_INLINE void store_block(const RgbaPack& c, Rgba* first, int row_length, MaskLanes inside) {
    alignas(64) Rgba pixels[4][4];  // [column][row]
    const RgbaQuads quads = quads_of(c);
    __builtin_memcpy(pixels, &quads, sizeof pixels);
    const unsigned bits = bits_of(inside);
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            if (bits >> (4 * row + column) & 1) first[row * row_length + column] = pixels[column][row];
}

}  // namespace CHIARO_ISA
template <>
struct RgbaOf<Lanes> {
    using type = RgbaPack;
};
#endif

/// Opacity of 1 at most; the colour stays.
template <class F>
CHIARO_INLINE RgbaLanes<F> limit_alpha(const RgbaLanes<F>& c) {
    const Rgba opacity{0, 0, 0, 1};
    return accumulate(c, min(F(1) - alpha_of(c), F(0)), load_rgba(&opacity, Int<F>(0)));
}

/// (1 - t) a + t b
template <class F>
CHIARO_INLINE RgbaLanes<F> mix(const RgbaLanes<F>& a, const RgbaLanes<F>& b, F t) {
    return accumulate(scale(a, F(1) - t), t, b);
}

/// Colours over stored values.
struct RgbaTable {
    const Rgba* entries;
    float scale, offset;  ///< index = stored * scale + offset, rounding included
    float last;

    template <class F>
    CHIARO_INLINE Int<F> index(F stored) const {
        return truncate(min(max(mad(stored, F(scale), F(offset)), F(0)), F(last)));
    }
    template <class F>
    CHIARO_INLINE RgbaLanes<F> at(F stored) const {
        return load_rgba(entries, index(stored));
    }
};

}  // namespace chiaro::kernel

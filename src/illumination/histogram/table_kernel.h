// O = Σ α_j LH_j and E = Σ α_j c_j LH_j of every word: four sums over one row of numbers.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

inline constexpr int word_parts = 16;

/// E's channels and O, of every sixteenth bin of [first, end) from the first on. `weights` [4][bins].
template <class F>
struct WordPart {
    F sum[4];

    CHIARO_INLINE WordPart(const std::uint16_t* shares, std::int32_t bins, std::int32_t first, std::int32_t end,
                           const float* weights) {
        for (F& part : sum) part = F(0);
        for (std::int32_t j = first; j < end; j += word_parts) {
            const F share = load_row<F>(shares + j);
            for (int c = 0; c < 4; ++c) sum[c] = mad(share, load_row<F>(weights + c * bins + j), sum[c]);
        }
    }
};

/// The sixteen parts of a sum, in pairs.
CHIARO_INLINE float fold(float (&sum)[word_parts]) {
    for (int half = word_parts / 2; half > 0; half /= 2)
        for (int l = 0; l < half; ++l) sum[l] += sum[l + half];
    return sum[0];
}

/// Sums over the bins [first, end) of `words` rows of 16-bit shares, `bins` long; out four numbers a word. Sixteen
/// partial sums each, then those in pairs: the same order everywhere.
template <class F>
CHIARO_INLINE void word_sums(const std::uint16_t* shares, std::int32_t words, std::int32_t bins, std::int32_t first,
                             std::int32_t end, const float* weights, float* out) {
    for (std::int32_t w = 0; w < words; ++w) {
        const std::uint16_t* row = shares + std::int64_t(w) * bins;
        float sums[4][word_parts];
        for (int p = 0; p < word_parts; p += LaneTraits<F>::count) {
            const WordPart<F> part(row + p, bins, first, end, weights + p);
            for (int c = 0; c < 4; ++c) store_row(sums[c] + p, part.sum[c]);
        }
        for (int c = 0; c < 4; ++c) out[4 * w + c] = fold(sums[c]);
    }
}

/// The same for many threads: one for each part of each word, then one for each sum.
struct WordTable {
    const std::uint16_t* shares;
    const float* weights;
    std::int32_t words, bins, first, end;
    float* parts;  ///< [word][4][part]
    float* out;    ///< [word][4]

    CHIARO_INLINE void find_part(std::int64_t item) const {
        const std::int64_t word = item / word_parts;
        const std::int32_t p = std::int32_t(item % word_parts);
        const WordPart<float> part(shares + word * bins + p, bins, first, end, weights + p);
        for (int c = 0; c < 4; ++c) parts[(word * 4 + c) * word_parts + p] = part.sum[c];
    }
    CHIARO_INLINE void fold_parts(std::int64_t item) const {
        float sum[word_parts];
        for (int p = 0; p < word_parts; ++p) sum[p] = parts[item * word_parts + p];
        out[item] = fold(sum);
    }
};

}  // namespace chiaro::kernel

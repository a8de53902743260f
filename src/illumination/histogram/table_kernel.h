// O = Σ α_j LH_j and E = Σ α_j c_j LH_j of every word: four sums over one row of numbers.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

inline constexpr int codeword_parts = 16;

/// E's channels and O, of every sixteenth bin of [first, end) from the first on. `weights` [4][bins].
template <class F>
struct CodewordPart {
    F sum[4];

    CHIARO_INLINE CodewordPart(const std::uint16_t* shares, std::int32_t bins, std::int32_t first, std::int32_t end,
                               const float* weights) {
        for (F& part : sum) part = F(0);
        for (std::int32_t j = first; j < end; j += codeword_parts) {
            const F share = load_row<F>(shares + j);
            for (int c = 0; c < 4; ++c) sum[c] = mad(share, load_row<F>(weights + c * bins + j), sum[c]);
        }
    }
};

/// The sixteen parts of a sum, in pairs.
CHIARO_INLINE float fold(float (&sum)[codeword_parts]) {
    for (int half = codeword_parts / 2; half > 0; half /= 2)
        for (int l = 0; l < half; ++l) sum[l] += sum[l + half];
    return sum[0];
}

/// Sums over the bins [first, end) of `words` rows of 16-bit shares, `bins` long; out four numbers a word. Sixteen
/// partial sums each, then those in pairs: the same order everywhere.
template <class F>
CHIARO_INLINE void codeword_sums(const std::uint16_t* shares, std::int32_t codewords, std::int32_t bins,
                                 std::int32_t first, std::int32_t end, const float* weights, float* out) {
    for (std::int32_t w = 0; w < codewords; ++w) {
        const std::uint16_t* row = shares + std::int64_t(w) * bins;
        float sums[4][codeword_parts];
        for (int p = 0; p < codeword_parts; p += LaneTraits<F>::count) {
            const CodewordPart<F> part(row + p, bins, first, end, weights + p);
            for (int c = 0; c < 4; ++c) store_row(sums[c] + p, part.sum[c]);
        }
        for (int c = 0; c < 4; ++c) out[4 * w + c] = fold(sums[c]);
    }
}

/// The same for many threads: one for each part of each word, then one for each sum.
struct CodewordTable {
    const std::uint16_t* shares;
    const float* weights;
    std::int32_t codewords, bins, first, end;
    float* parts;  ///< [word][4][part]
    float* out;    ///< [word][4]

    CHIARO_INLINE void find_part(std::int64_t item) const {
        const std::int64_t codeword = item / codeword_parts;
        const std::int32_t p = std::int32_t(item % codeword_parts);
        const CodewordPart<float> part(shares + codeword * bins + p, bins, first, end, weights + p);
        for (int c = 0; c < 4; ++c) parts[(codeword * 4 + c) * codeword_parts + p] = part.sum[c];
    }
    CHIARO_INLINE void fold_parts(std::int64_t item) const {
        float sum[codeword_parts];
        for (int p = 0; p < codeword_parts; ++p) sum[p] = parts[item * codeword_parts + p];
        out[item] = fold(sum);
    }
};

}  // namespace chiaro::kernel

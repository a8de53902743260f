// O = Σ α_j LH_j and E = Σ α_j c_j LH_j of every word: four sums over one row of numbers.
#pragma once
#include "kernel/row.h"

namespace chiaro::kernel {

/// Sums over the bins [first, end) of `words` rows of 16-bit shares, `bins` long: weights [4][bins] of E's channels and
/// O; out four numbers a word. Sixteen partial sums each, then those in pairs: the same order everywhere.
template <class F>
CHIARO_INLINE void word_sums(const std::uint16_t* shares, std::int32_t words, std::int32_t bins, std::int32_t first,
                             std::int32_t end, const float* weights, float* out) {
    constexpr int lanes = LaneTraits<F>::count, parts = 16 / lanes;
    for (std::int32_t w = 0; w < words; ++w) {
        const std::uint16_t* row = shares + std::int64_t(w) * bins;
        F sums[4][parts];
        for (auto& sum : sums)
            for (F& part : sum) part = F(0);
        for (std::int32_t j = first; j < end; j += 16)
            for (int p = 0; p < parts; ++p) {
                const F share = load_row<F>(row + j + p * lanes);
                for (int c = 0; c < 4; ++c)
                    sums[c][p] = mad(share, load_row<F>(weights + c * bins + j + p * lanes), sums[c][p]);
            }
        for (int c = 0; c < 4; ++c) {
            float sum[16];
            for (int p = 0; p < parts; ++p) store_row(sum + p * lanes, sums[c][p]);
            for (int half = 8; half > 0; half /= 2)
                for (int l = 0; l < half; ++l) sum[l] += sum[l + half];
            out[4 * w + c] = sum[0];
        }
    }
}

}  // namespace chiaro::kernel

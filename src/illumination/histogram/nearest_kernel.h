// The nearest of many packed histograms, in whole numbers: the same whatever the order of sums.
#pragma once
#include "illumination/histogram/codebook_view.h"
#include "kernel/lanes.h"
#include "kernel/shorts.h"

namespace chiaro::kernel {

/// Squared distance (L2), sum (L1) or largest (Lmax) of the differences of two vectors.
template <CodebookMetric metric>
CHIARO_INLINE std::int32_t difference(const std::int16_t* a, const std::int16_t* b, int bins) {
    std::int32_t sum = 0;
    std::int16_t largest = 0;
    for_both(a, b, 0, bins, [&](std::int16_t u, std::int16_t v) CHIARO_INLINE_LAMBDA {
        const std::int16_t d = std::int16_t(u - v), size = std::int16_t(d < 0 ? -d : d);
        if constexpr (metric == CodebookMetric::l2) sum += std::int32_t(d) * std::int32_t(d);
        if constexpr (metric == CodebookMetric::l1) sum += size;
        if constexpr (metric == CodebookMetric::lmax) largest = size > largest ? size : largest;
    });
    return metric == CodebookMetric::lmax ? largest : sum;
}
/// Of a vector and four words.
template <CodebookMetric metric>
CHIARO_INLINE void differences(const CodebookView& codebook, const std::int16_t* x, const std::int32_t (&codeword)[4],
                               std::int32_t (&found)[4]) {
    const std::int16_t* to[4];
    for (int i = 0; i < 4; ++i) to[i] = codebook.codewords + std::int64_t(codeword[i]) * codebook.bins;
    if constexpr (metric == CodebookMetric::l2)
        square_distances(x, to, codebook.bins, found);
    else
        for (int i = 0; i < 4; ++i) found[i] = difference<metric>(x, to[i], codebook.bins);
}

/// use(word, difference)
template <CodebookMetric metric, class Use>
CHIARO_INLINE void for_each_codeword(const CodebookView& codebook, const std::int16_t* x, Use&& use) {
    for (std::int32_t first = 0; first < codebook.count; first += 4) {
        std::int32_t c[4], d[4];
        for (int k = 0; k < 4; ++k) c[k] = min(first + k, codebook.count - 1);
        differences<metric>(codebook, x, c, d);
        for (int k = 0; k < 4 && first + k < codebook.count; ++k) use(first + k, d[k]);
    }
}

/// What obeys the triangle inequality.
template <CodebookMetric metric>
CHIARO_INLINE float distance_of(std::int32_t difference) {
    return metric == CodebookMetric::l2 ? sqrt(float(difference)) : float(difference);
}

/// A word, how far it is, and whether none is nearer.
struct FoundCodeword {
    std::int32_t codeword, difference;
    bool is_nearest;
};

/// The nearest word to x, of equals the first, where the neighbours tell. A word c can be nearer than the best known
/// only where d(s, c) <= d(x, s) + d(x, best) for a word s (triangle inequality), so the neighbours of a good guess s
/// are tried in order until they are too far. Where the list of neighbours ends before that any word may be nearer.
template <CodebookMetric metric>
CHIARO_INLINE FoundCodeword near_codeword(const CodebookView& codebook, const std::int16_t* x, FoundCodeword guess) {
    std::int32_t best = guess.codeword, least = guess.difference;
    for (;;) {
        const std::int32_t start = best;
        const float from_start = distance_of<metric>(least);
        float reach = 2 * from_start * 1.00001f + 0.01f;  // rounding never loses a word
        const std::uint16_t* const near = codebook.neighbours + std::int64_t(start) * codebook.listed;
        const float* const away = codebook.distances + std::int64_t(start) * codebook.listed;
        std::int32_t i = 0;
        bool is_far_off = false;
        for (; i < codebook.listed && away[i] <= reach && !is_far_off; i += 4) {
            std::int32_t c[4], d[4];
            for (int k = 0; k < 4; ++k) c[k] = near[min(i + k, codebook.listed - 1)];
            differences<metric>(codebook, x, c, d);
            for (int k = 0; k < 4; ++k) {
                if (d[k] > least || (d[k] == least && c[k] >= best)) continue;
                best = c[k], least = d[k];
                const float to_best = distance_of<metric>(d[k]);
                reach = (from_start + to_best) * 1.00001f + 0.01f;
                is_far_off = to_best < 0.7f * from_start;  // its own neighbours are fewer
            }
        }
        if (!is_far_off) return {best, least, i < codebook.listed || codebook.listed == codebook.count - 1};
    }
}
/// The nearest of four guesses, of equals the first.
template <CodebookMetric metric>
CHIARO_INLINE FoundCodeword best_of(const CodebookView& codebook, const std::int16_t* x,
                                    const std::int32_t (&guess)[4]) {
    std::int32_t found[4], best = 0;
    differences<metric>(codebook, x, guess, found);
    for (int i = 1; i < 4; ++i)
        if (found[i] < found[best]) best = i;
    return {guess[best], found[best], false};
}
/// The nearest of all words, `found` being one.
template <CodebookMetric metric>
CHIARO_INLINE FoundCodeword codeword_of_all(const CodebookView& codebook, const std::int16_t* x, FoundCodeword found) {
    for_each_codeword<metric>(codebook, x, [&](std::int32_t c, std::int32_t d) CHIARO_INLINE_LAMBDA {
        if (d < found.difference || (d == found.difference && c < found.codeword))
            found.codeword = c, found.difference = d;
    });
    return {found.codeword, found.difference, true};
}
template <CodebookMetric metric>
CHIARO_INLINE FoundCodeword nearest_codeword(const CodebookView& codebook, const std::int16_t* x, FoundCodeword guess) {
    const FoundCodeword near = near_codeword<metric>(codebook, x, guess);
    return near.is_nearest ? near : codeword_of_all<metric>(codebook, x, near);
}

template <CodebookMetric metric>
struct OfMetric {
    static constexpr CodebookMetric value = metric;
};
/// use(of) by the book's metric, decltype(of)::value.
template <class Use>
CHIARO_INLINE auto by_metric(const CodebookView& codebook, Use&& use) {
    if (codebook.metric == CodebookMetric::l1) return use(OfMetric<CodebookMetric::l1>());
    if (codebook.metric == CodebookMetric::lmax) return use(OfMetric<CodebookMetric::lmax>());
    return use(OfMetric<CodebookMetric::l2>());
}
CHIARO_INLINE std::int32_t difference_of(const CodebookView& codebook, const std::int16_t* a, const std::int16_t* b) {
    return by_metric(
        codebook, [&](auto of) CHIARO_INLINE_LAMBDA { return difference<decltype(of)::value>(a, b, codebook.bins); });
}
CHIARO_INLINE FoundCodeword guessed(const CodebookView& codebook, const std::int16_t* x, std::int32_t guess) {
    return {guess, difference_of(codebook, x, codebook.codewords + std::int64_t(guess) * codebook.bins), false};
}
CHIARO_INLINE FoundCodeword near_codeword(const CodebookView& codebook, const std::int16_t* x, std::int32_t guess) {
    return by_metric(codebook, [&](auto of) CHIARO_INLINE_LAMBDA {
        return near_codeword<decltype(of)::value>(codebook, x, guessed(codebook, x, guess));
    });
}
CHIARO_INLINE FoundCodeword codeword_of_all(const CodebookView& codebook, const std::int16_t* x, FoundCodeword found) {
    return by_metric(codebook, [&](auto of) CHIARO_INLINE_LAMBDA {
        return codeword_of_all<decltype(of)::value>(codebook, x, found);
    });
}
CHIARO_INLINE FoundCodeword nearest_codeword(const CodebookView& codebook, const std::int16_t* x, std::int32_t guess) {
    return by_metric(codebook, [&](auto of) CHIARO_INLINE_LAMBDA {
        return nearest_codeword<decltype(of)::value>(codebook, x, guessed(codebook, x, guess));
    });
}
CHIARO_INLINE FoundCodeword nearest_codeword(const CodebookView& codebook, const std::int16_t* x,
                                             const std::int32_t (&guess)[4]) {
    return by_metric(codebook, [&](auto of) CHIARO_INLINE_LAMBDA {
        constexpr CodebookMetric metric = decltype(of)::value;
        return nearest_codeword<metric>(codebook, x, best_of<metric>(codebook, x, guess));
    });
}
CHIARO_INLINE float distance_of(const CodebookView& codebook, std::int32_t difference) {
    return by_metric(codebook,
                     [&](auto of) CHIARO_INLINE_LAMBDA { return distance_of<decltype(of)::value>(difference); });
}

/// Whether `x` is what lies `beside` it (null: nothing does), so that its word is too.
CHIARO_INLINE bool is_same(const CodebookView& codebook, const std::int16_t* beside, const std::int16_t* x) {
    if (!beside) return false;
    std::int16_t differ = 0;
    for_both(x, beside, 0, codebook.bins,
             [&](std::int16_t u, std::int16_t v) CHIARO_INLINE_LAMBDA { differ = std::int16_t(differ | (u ^ v)); });
    return differ == 0;
}

/// Identifiers of a row of cells, two histograms each. A cell's guesses are the words of the one before and of those in
/// the rows `above` and `behind` (null: unknown); the first one's are in `codewords`.
CHIARO_INLINE void assign_row(const CodebookView& codebook, const std::int16_t* histograms, std::int32_t count,
                              const std::uint16_t* above, const std::uint16_t* behind, std::uint16_t* codewords) {
    for (int side = 0; side < 2; ++side) {
        std::int32_t codeword = codewords[side];
        const std::int16_t* before = nullptr;
        for (int i = 0; i < count; ++i) {
            const std::int16_t* x = histograms + (2 * i + side) * codebook.bins;
            const std::int32_t of_above = above ? above[2 * i + side] : codeword,
                               of_behind = behind ? behind[2 * i + side] : codeword;
            if (!is_same(codebook, before, x))
                codeword = nearest_codeword(codebook, x, {codeword, of_above, of_behind, codeword}).codeword;
            codewords[2 * i + side] = std::uint16_t(codeword);
            before = x;
        }
    }
}

/// Words of single histograms, and how far they are; `words` holds the guesses.
CHIARO_INLINE void assign_each(const CodebookView& codebook, const std::int16_t* histograms, std::int32_t count,
                               std::uint16_t* codewords, std::int32_t* differences) {
    for (int i = 0; i < count; ++i) {
        const FoundCodeword found = nearest_codeword(codebook, histograms + i * codebook.bins, codewords[i]);
        codewords[i] = std::uint16_t(found.codeword), differences[i] = found.difference;
    }
}

/// Differences of one word to all.
CHIARO_INLINE void differences_to(const CodebookView& codebook, const std::int16_t* x, std::int32_t* out) {
    by_metric(codebook, [&](auto of) CHIARO_INLINE_LAMBDA {
        for_each_codeword<decltype(of)::value>(
            codebook, x, [&](std::int32_t c, std::int32_t d) CHIARO_INLINE_LAMBDA { out[c] = d; });
    });
}

}  // namespace chiaro::kernel

// The unpacked histograms of words' members, as threads of a GPU add them up.
#pragma once
#include "illumination/histogram/exact_kernel.h"

namespace chiaro::kernel {

/// A ball around a cell, or half of it.
struct CodewordMember {
    std::int32_t x, y, z;
    BallPart part;
};

/// A thread for each member.
struct CountMembers {
    BallView ball;
    BinGrid cells;
    const CodewordMember* members;
    std::int32_t bins;
    float* counts;  ///< [member][4][bins], 0 at first

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const CodewordMember& m = members[item];
        const Float3 g = cells.gradient(m.x, m.y, m.z);
        const float side = m.part == BallPart::backward ? -1.0f : 1.0f,
                    gradient[] = {side * g.x, side * g.y, side * g.z};
        count_ball(ball, places_around(cells, m.x, m.y, m.z), gradient, m.part == BallPart::whole, bins,
                   counts + item * 4 * bins);
    }
};

/// Then one for each bin of each word.
struct AddUpMembers {
    const CodewordMember* members;
    const std::int32_t* begin;  ///< of each word its first member, and the last one's end
    std::int32_t bins;
    const float* counts;
    float* histograms;  ///< [word][bins]

    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int32_t codeword = std::int32_t(item / bins), k = std::int32_t(item % bins);
        float sum = 0;
        for (std::int32_t i = begin[codeword] - *begin; i < begin[codeword + 1] - *begin; ++i)
            sum += scale_of(members[i].part) * count_of(counts + std::int64_t(i) * 4 * bins, bins, k);
        histograms[item] = sum;
    }
};

}  // namespace chiaro::kernel

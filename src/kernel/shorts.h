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

}  // namespace chiaro::kernel

// Where bins go when histograms are packed, as kernels read it.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// Bin j goes to packed bin low[j] with share[j] / 256, and to the next with the rest.
struct PackingView {
    static constexpr std::int32_t whole = 256;
    const std::uint16_t *low, *share;

    /// Adds `amount` of a bin to a packed histogram.
    CHIARO_INLINE void add(std::int32_t bin, float amount, float* packed) const {
        const std::int32_t part = share[bin];
        packed[low[bin]] += amount * float(part) / whole;
        if (part < whole) packed[low[bin] + 1] += amount * float(whole - part) / whole;
    }
    /// 256ths, or away.
    template <int sign>
    CHIARO_INLINE void add(std::int32_t bin, std::int32_t* packed) const {
        const std::int32_t part = share[bin];
        packed[low[bin]] += sign * part;
        if (part < whole) packed[low[bin] + 1] += sign * (whole - part);
    }
};

}  // namespace chiaro::kernel

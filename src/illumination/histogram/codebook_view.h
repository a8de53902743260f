// Words of a codebook as the search for the nearest reads them.
#pragma once
#include <cstdint>

namespace chiaro::kernel {

/// What stands for 1 in a packed histogram. Squared distances of vectors whose sums are up to 1.4 fit in 31 bits, also
/// of two that have no bin in common.
inline constexpr std::int32_t packed_one = 16384;

enum class CodebookMetric : std::int32_t { l2, l1, lmax };

struct CodebookView {
    const std::int16_t* codewords;  ///< `count` vectors of `bins` numbers, packed_one for 1; bins is a multiple of 16
    std::int32_t count, bins;
    CodebookMetric metric;
    const std::uint16_t* neighbours;  ///< of each word the `listed` nearest others, by distance
    const float* distances;
    std::int32_t listed;
};

}  // namespace chiaro::kernel

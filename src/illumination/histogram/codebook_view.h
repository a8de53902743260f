// Words of a codebook as the search for the nearest reads them.
#pragma once
#include <cstdint>

namespace chiaro::kernel {

enum class CodebookMetric : std::int32_t { l2, l1, lmax };

struct CodebookView {
    const std::int16_t* words;  ///< `count` vectors of `bins` numbers, 32767ths; bins is a multiple of 16
    std::int32_t count, bins;
    CodebookMetric metric;
    const std::uint16_t* neighbours;  ///< of each word the `listed` nearest others, by distance
    const float* distances;
    std::int32_t listed;
};

}  // namespace chiaro::kernel

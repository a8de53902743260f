// Where a number for each cell or node lies, as a sweep meets them.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// Of a sweep's first cell, and so far on from plane to plane, row to row, cell to cell.
struct SweptPlaces {
    std::int64_t first, plane, row, cell;

    CHIARO_INLINE std::int64_t at(std::int32_t k, std::int32_t v, std::int32_t u) const {
        return first + k * plane + v * row + u * cell;
    }
};

}  // namespace chiaro::kernel

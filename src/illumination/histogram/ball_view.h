// A ball of cells, and what lies around a cell, as kernels read them.
#pragma once
#include <cstdint>

namespace chiaro::kernel {

struct BallRow {
    std::int32_t dy, dz, reach;
};
struct BallView {
    static constexpr int max_reach = 64;
    const BallRow* row;
    std::int32_t rows;
    const float* weights;  ///< of every cell, row after row
};

/// Forward is the half that ∇f points to.
enum class BallPart : std::int32_t { forward, backward, whole };

/// A cell's place in a histogram, those of its neighbours, and how far the volume goes before and behind it.
struct CellNeighbours {
    const std::uint16_t* here;
    std::int32_t row, slice;  ///< distances along y and z
    std::int32_t before[3], behind[3];
};

}  // namespace chiaro::kernel

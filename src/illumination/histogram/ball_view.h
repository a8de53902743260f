// A ball of cells, and a tile of what lies in them, as kernels read them.
#pragma once
#include <cstdint>

namespace chiaro::kernel {

struct BallRow {
    std::int32_t dy, dz, reach;
};
struct BallView {
    static constexpr int most_reach = 64;
    const BallRow* row;
    std::int32_t rows;
    const float* weight;  ///< by squared distance
};
inline constexpr int run_lanes = 16;  ///< cells of a run, whatever the instruction set
struct PlaceTile {
    const std::uint16_t* first;
    std::int32_t row, slice;
};

}  // namespace chiaro::kernel

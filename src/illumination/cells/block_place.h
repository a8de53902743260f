// A block of cells as a card's threads are told of it.
#pragma once
#include <cstdint>

namespace chiaro::kernel {

struct BlockPlace {
    static constexpr int edge = 32, cells = edge * edge * edge, width = 16, height = 4;
    std::int32_t first[3];                              ///< cell or corner
    std::uint8_t pieces[edge / height][edge / height];  ///< that are asked for: bit x of [z][y], 16 × 4 × 4 each
};

}  // namespace chiaro::kernel

// A kernel of a grid's nodes, for a thread each.
#pragma once
#include <cstdint>

#include "kernel/lanes.h"

namespace chiaro::kernel {

/// kernel(node, x, y, z), x fastest.
template <class Kernel>
struct EachNode {
    Kernel kernel;
    std::int32_t nx, ny;

    CHIARO_INLINE void operator()(std::int64_t node) const {
        kernel(node, std::int32_t(node % nx), std::int32_t(node / nx % ny), std::int32_t(node / nx / ny));
    }
};

}  // namespace chiaro::kernel

// Halving density as CUDA sees it: the same source, one thread a row. Compiled wherever nvcc exists.
#include "illumination/visibility/rows.h"

namespace chiaro::kernel {

__global__ void transmittance_of(const float* depth, std::int32_t count, float* to) {
    const std::int32_t first = std::int32_t(blockIdx.x * blockDim.x + threadIdx.x) * most_nodes;
    if (first < count) transmittance_row<float>(depth + first, most_nodes, to + first);
}

/// The rows of a tile of edge³ cells.
__global__ void halve_tile(const float* open, std::int32_t edge, float* nodes) {
    const std::int32_t half = edge / 2, y = std::int32_t(threadIdx.x), z = std::int32_t(blockIdx.x);
    if (y >= half || z >= half) return;
    const float* first = open + (2 * z * edge + 2 * y) * edge;
    const FourRows rows{{first, first + edge, first + edge * edge, first + edge * edge + edge}};
    halve_row<float>(rows, half, nodes + (z * half + y) * half);
}

}  // namespace chiaro::kernel

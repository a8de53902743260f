// Local histograms as CUDA sees them: the same source, one thread a cell, a block, a row or a histogram.
// Compiled wherever nvcc exists.
#include "illumination/histogram/exact_kernel.h"
#include "illumination/histogram/fast_kernel.h"
#include "illumination/histogram/nearest_kernel.h"

namespace chiaro::kernel {
namespace {

__device__ std::int32_t item() { return std::int32_t(blockIdx.x * blockDim.x + threadIdx.x); }

}  // namespace

/// Half balls, or whole ones, around single cells; counts [4][places] of each, zero at first.
__global__ void count_balls(BallView ball, const CellPlaces* cells, const float* gradients, std::int32_t count,
                            bool whole, std::int32_t places, float* counts) {
    const std::int32_t i = item();
    if (i < count) count_ball(ball, cells[i], gradients + 3 * i, whole, places, counts + std::int64_t(i) * 4 * places);
}

/// Blocks, each with room of its own; then their planes, and the rows of those.
__global__ void sum_blocks(const FastBlock* blocks, std::int32_t count) {
    if (item() < count) fast_sums<float>(blocks[item()]);
}
__global__ void plane_of_blocks(const FastBlock* blocks, std::int32_t count, std::int32_t fine_z) {
    if (item() < count) fast_plane<float>(blocks[item()], fine_z);
}
__global__ void row_of_blocks(const FastBlock* blocks, std::int32_t count, std::int32_t fine_y, std::int32_t fine_z,
                              std::int32_t cells, const float* normals, std::int16_t* histograms) {
    const std::int32_t i = item();
    if (i < count)
        fast_cells<float>(blocks[i], fine_y, fine_z, cells, 1, normals + std::int64_t(i) * 3 * cells,
                          histograms + std::int64_t(i) * 2 * cells * blocks[i].bins);
}

/// Words of single histograms; `words` holds the guesses.
__global__ void assign_histograms(CodebookView book, const std::int16_t* histograms, std::int32_t count,
                                  std::uint16_t* words, std::int32_t* differences) {
    const std::int32_t i = item();
    if (i < count) assign_each(book, histograms + std::int64_t(i) * book.bins, 1, words + i, differences + i);
}

}  // namespace chiaro::kernel

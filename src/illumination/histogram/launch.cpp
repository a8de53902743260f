#include "kernel/launch.h"
#include "illumination/histogram/exact_kernel.h"
#include "illumination/histogram/fast_kernel.h"
#include "illumination/histogram/functions.h"
#include "illumination/histogram/nearest_kernel.h"
#include "illumination/histogram/table_kernel.h"

namespace chiaro::kernel::CHIARO_ISA {

HistogramFunctions histogram_functions() {
    return {
        [](const BallView& ball, const CellNeighbours& cell, const float* gradient, bool whole, std::int32_t places,
           float* counts) { count_ball(ball, cell, gradient, whole, places, counts); },
        [](const FastBlock& block) { fast_sums<NativeLanes>(block); },
        [](const FastBlock& block, int fine_z) { fast_plane<NativeLanes>(block, fine_z); },
        [](const FastBlock& block, int fine_y, int fine_z, int count, int step, const float* normals,
           std::int16_t* histograms) {
            fast_cells<NativeLanes>(block, fine_y, fine_z, count, step, normals, histograms);
        },
        [](const CodebookView& codebook, const std::int16_t* histograms, std::int32_t count, const std::uint16_t* above,
           const std::uint16_t* behind,
           std::uint16_t* codewords) { assign_row(codebook, histograms, count, above, behind, codewords); },
        [](const CodebookView& codebook, const std::int16_t* histograms, std::int32_t count, std::uint16_t* codewords,
           std::int32_t* differences) { assign_each(codebook, histograms, count, codewords, differences); },
        [](const CodebookView& codebook, const std::int16_t* histogram, std::int32_t* differences) {
            differences_to(codebook, histogram, differences);
        },
        [](const std::uint16_t* shares, std::int32_t codewords, std::int32_t bins, std::int32_t first, std::int32_t end,
           const float* weights,
           float* out) { codeword_sums<NativeLanes>(shares, codewords, bins, first, end, weights, out); },
    };
}

}  // namespace chiaro::kernel::CHIARO_ISA

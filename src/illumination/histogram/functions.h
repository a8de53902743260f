// The kernels of local histograms behind one table of functions.
#pragma once
#include "illumination/histogram/ball_view.h"
#include "illumination/histogram/codebook_view.h"
#include "illumination/histogram/fast_block.h"

namespace chiaro::kernel {

struct HistogramFunctions {
    void (*count_ball)(const BallView&, const CellNeighbours&, const float* gradient, bool whole, std::int32_t places,
                       float* counts);
    void (*fast_sums)(const FastBlock&);
    void (*fast_plane)(const FastBlock&, int fine_z);
    void (*fast_cells)(const FastBlock&, int fine_y, int fine_z, int count, int step, const float* normals,
                       std::int16_t* histograms);
    void (*assign_row)(const CodebookView&, const std::int16_t* histograms, std::int32_t count,
                       const std::uint16_t* above, const std::uint16_t* behind, std::uint16_t* codewords);
    void (*assign_each)(const CodebookView&, const std::int16_t* histograms, std::int32_t count,
                        std::uint16_t* codewords, std::int32_t* differences);
    void (*differences_to)(const CodebookView&, const std::int16_t* histogram, std::int32_t* differences);
    void (*codeword_sums)(const std::uint16_t* shares, std::int32_t codewords, std::int32_t bins, std::int32_t first,
                          std::int32_t end, const float* weights, float* out);
};

}  // namespace chiaro::kernel

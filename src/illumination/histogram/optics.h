// What a transfer function makes of bins, and so of the words: a table that is found again after every edit.
#pragma once
#include "classify/medium.h"
#include "illumination/histogram/histograms.h"

namespace chiaro {

/// What each bin of the histograms looks like.
struct BinOptics {
    std::vector<float> alpha;               ///< of ONE smallest voxel edge
    std::vector<std::array<float, 3>> rgb;  ///< as the medium's table holds colours
    std::vector<float> emission;            ///< h in [1, h_max]; empty: nothing glows
};
/// Of a volume: α = 1 - exp(-κ e); of isosurfaces: of the cell's material, 1 at or above the lowest value (times its
/// opacity), and the colour of the highest surface below. `glow` as in HistogramSettings. Throws Error{usage, input}
/// for one that cannot be read.
BinOptics optics_of_bins(const Medium::Data& medium, const LocalHistograms& histograms, const std::string& emission);

/// O = Σ α_j LH_j and E = Σ α_j h_j c_j LH_j of every word: E's channels, then O.
std::vector<std::array<float, 4>> codeword_sums(const Device& device, const LocalHistograms& histograms,
                                                const BinOptics& optics);

}  // namespace chiaro

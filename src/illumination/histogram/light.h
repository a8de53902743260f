// What a transfer function makes of the words: a table of a few thousand colours, found again after every edit.
#pragma once
#include <memory>

#include "classify/medium.h"
#include "illumination/histogram/field.h"
#include "illumination/histogram/histograms.h"

namespace chiaro {

/// What each bin of the histograms looks like.
struct BinOptics {
    std::vector<float> alpha;               ///< of ONE smallest voxel edge
    std::vector<std::array<float, 3>> rgb;  ///< as the medium's table holds colours
    std::vector<float> glow;                ///< h in [1, h_max]; empty: nothing glows
};
/// Of a volume: α = 1 - exp(-κ e); of isosurfaces: of the cell's material, 1 at or above the lowest value (times its
/// opacity), and the colour of the highest surface below. `glow` as in HistogramSettings. Throws Error{usage, input}
/// for one that cannot be read.
BinOptics optics_of_bins(const Medium::Data& medium, const LocalHistograms& histograms, const std::string& glow);

/// O = Σ α_j LH_j and E = Σ α_j h_j c_j LH_j of every word: E's channels, then O.
std::vector<std::array<float, 4>> word_sums(const Device& device, const LocalHistograms& histograms,
                                            const BinOptics& optics);

/// What a picture looks up: everything that a HistogramView points to.
struct HistogramLight {
    std::shared_ptr<const LocalHistograms> histograms;
    std::vector<kernel::Rgba> words;
    std::vector<float> side;              ///< by entry of the medium's table
    std::vector<kernel::Rgba> glow;       ///< of what glows; else empty
    std::vector<std::uint8_t> occupancy;  ///< likewise
    std::vector<kernel::Rgba> albedo;     ///< likewise; of the paper's model
    kernel::HistogramView view{};

    std::size_t bytes() const { return words.size() * sizeof words[0] + side.size() * sizeof side[0]; }
};

/// Cost: one pass over the words, some milliseconds for 2048 of 4096 bins.
std::shared_ptr<const HistogramLight> make_histogram_light(const Device& device, const Medium::Data& medium,
                                                           std::shared_ptr<const LocalHistograms> histograms,
                                                           const HistogramSettings& settings);

/// O_env of every voxel (one component), or with colour bleeding E_env (RGB), on the volume's grid: of the half ball
/// that faces outwards there, unlifted and between nodes interpolated.
Volume histogram_field(const Device& device, const Medium::Data& medium, const LocalHistograms& histograms,
                       const HistogramSettings& settings, Progress& progress);

}  // namespace chiaro

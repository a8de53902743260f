// Which values glow, how strongly, and how far.
#pragma once
#include <vector>

#include "illumination/histogram/emission_mapping.h"
#include "illumination/histogram/field.h"
#include "illumination/histogram/histograms.h"
#include "illumination/histogram/optics.h"
#include "kernel/rgba.h"

namespace chiaro {

/// G = Σ α_j (h_j - 1) / (h_max - 1) LH_j of every word, with its colour, as opacity of one edge. The paper takes it
/// for that, which makes solid clouds; here it is the opacity of a length of r.
std::vector<kernel::Rgba> emission_of_codewords(const Device& device, const LocalHistograms& histograms,
                                                BinOptics optics, HistogramModel model);

/// The medium's occupancy, and every cell in which a sample may read a node whose word glows: `view` with its nodes and
/// emission_codewords. Cost: one pass over the nodes.
std::vector<std::uint8_t> emissive_occupancy(const Device& device, const Medium::Data& medium,
                                             const LocalHistograms& histograms, const kernel::HistogramView& view);

}  // namespace chiaro

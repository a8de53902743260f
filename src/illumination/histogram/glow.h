// Which values glow, how strongly, and how far.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "illumination/histogram/field.h"
#include "illumination/histogram/histograms.h"
#include "illumination/histogram/optics.h"
#include "kernel/rgba.h"

namespace chiaro {

/// h(value) >= 1, where 1 does not glow: one strength between two values, or straight lines between the points of a
/// file; 1 outside.
class GlowMapping {
public:
    GlowMapping() = default;
    /// "LO:HI=STRENGTH", or a file of lines "VALUE STRENGTH", values not falling; '#' begins a comment. Throws
    /// Error{usage} for a mapping, Error{input} for a file that cannot be read.
    explicit GlowMapping(const std::string& text);

    double at(double value) const;

private:
    /// What is wrong with a point behind those that are there, or nothing.
    std::string fault_of(double value, double strength) const;
    std::vector<std::pair<double, double>> points_;
};

/// G = Σ α_j (h_j - 1) / (h_max - 1) LH_j of every word, with its colour, as opacity of one edge. The paper takes it
/// for that, which makes solid clouds; here it is the opacity of a length of r.
std::vector<kernel::Rgba> glow_of_words(const Device& device, const LocalHistograms& histograms, BinOptics optics,
                                        HistogramModel model);

/// The medium's occupancy, and every cell in which a sample may read a node whose word glows: `view` with its nodes and
/// glow_words. Cost: one pass over the nodes.
std::vector<std::uint8_t> glowing_occupancy(const Device& device, const Medium::Data& medium,
                                            const LocalHistograms& histograms, const kernel::HistogramView& view);

}  // namespace chiaro

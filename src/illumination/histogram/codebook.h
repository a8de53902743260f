// A few histograms that stand for all: vector quantisation (Linde, Buzo and Gray 1980).
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>
#include <chiaro/progress.h>

#include <vector>

#include "core/host_array.h"
#include "illumination/histogram/codebook_view.h"

namespace chiaro {

/// Packed histograms are vectors of 16-bit numbers, packed_one for 1, as long as a multiple of 16.
using PackedHistogram = std::int16_t;
using kernel::packed_one;
constexpr int padded_bins(int packed) { return (packed + 15) / 16 * 16; }

/// Words, and for each its nearest others, which is what makes the search for the nearest word short.
class Codebook {
public:
    Codebook(const Device& device, int bins, HistogramMetric metric, std::vector<PackedHistogram> words);

    int count() const { return int(words_.size()) / bins_; }
    int bins() const { return bins_; }
    const std::vector<PackedHistogram>& words() const { return words_; }
    kernel::CodebookView view() const;
    void add_to(HostArrays& arrays) const {
        arrays.add(words_);
        arrays.add(neighbours_);
        arrays.add(distances_);
    }

private:
    static constexpr int most_listed = 256;
    int bins_, listed_ = 0;
    HistogramMetric metric_;
    std::vector<PackedHistogram> words_;
    std::vector<std::uint16_t> neighbours_;
    std::vector<float> distances_;
};

/// What a codebook is trained with, and how it went.
struct Training {
    int words = 2048;
    HistogramMetric metric = HistogramMetric::l2;
    double least_gain = 1e-3;  ///< relative; less ends the refinement between two splits
    /// Mean difference of the vectors to their words after each step: squared distance, sum or largest.
    std::vector<double> distortions;
};

/// Splits words (those with the largest distortion first: beside a word comes one half way to its farthest member) and
/// refines them (each becomes the mean of its members; one without takes the vector farthest from its own) until there
/// are as many as wanted, or every vector is a word. A step that rounding made worse is taken back, so the distortion
/// never rises under L2. The result does not depend on the number of threads. Cost: some 50 assignments of all vectors.
Codebook train_codebook(const Device& device, const std::vector<PackedHistogram>& vectors, int bins, Training& training,
                        Progress& progress);

}  // namespace chiaro

// A few histograms that stand for all: vector quantisation (Linde, Buzo and Gray 1980).
#pragma once
#include <chiaro/device.h>
#include <chiaro/lighting.h>
#include <chiaro/progress.h>

#include <vector>

#include "illumination/histogram/packed_histograms.h"

namespace chiaro {

/// Words, and for each its nearest others, which is what makes the search for the nearest word short.
class Codebook {
public:
    Codebook(const Device& device, int bins, HistogramMetric metric, std::vector<PackedHistogram> codewords);

    int count() const { return int(codewords_.size()) / bins_; }
    int bins() const { return bins_; }
    const std::vector<PackedHistogram>& codewords() const { return codewords_; }
    kernel::CodebookView view() const;
    kernel::CodebookView view_on_gpu(cuda::Stream& stream) const;

private:
    kernel::CodebookView view_of(const PackedHistogram* codewords, const std::byte* neighbours,
                                 const std::byte* distances) const;
    const PackedHistogram* codewords_on_gpu(cuda::Stream& stream) const;
    void list_neighbours(const Device& device);
    void list_on_gpu(const Device& device);

    static constexpr int max_listed = 256;
    int bins_, listed_ = 0;
    HistogramMetric metric_;
    std::vector<PackedHistogram> codewords_;
    std::shared_ptr<const char> life_ = std::make_shared<const char>();  ///< by which a GPU knows the words
    MirroredBuffer neighbours_{0}, distances_{0};
};

/// What a codebook is trained with, and how it went.
struct Training {
    int codewords = 2048;
    HistogramMetric metric = HistogramMetric::l2;
    double least_gain = 1e-3;  ///< relative; less ends the refinement between two splits
    /// Mean difference of the vectors to their words after each step: squared distance, sum or largest.
    std::vector<double> distortions;
};

/// Splits words (those with the largest distortion first: beside a word comes one half way to its farthest member) and
/// refines them (each becomes the mean of its members; one without takes the vector farthest from its own) until there
/// are as many as wanted, or every vector is a word. A step that rounding made worse is taken back, so the distortion
/// never rises under L2. The result does not depend on the number of threads. Cost: some 50 assignments of all vectors.
Codebook train_codebook(const Device& device, const PackedHistograms& vectors, int bins, Training& training,
                        Progress& progress);

}  // namespace chiaro

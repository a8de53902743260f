// What GPUs do of local histograms.
#pragma once
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/gpu_source.h"
#include "illumination/histogram/histograms.h"
#include "illumination/histogram/members.h"

namespace chiaro {

/// Identifiers of every node, which stay there too.
void assign_on_gpu(const Device& device, const HistogramData& data, HistogramPath path, const Codebook& codebook,
                   LocalHistograms& out, Progress& progress);

/// As find_codewords, from the members that were taken. Memory there: 16 bytes a bin of each, 1 GiB at most.
void find_codewords_on_gpu(const Device& device, const BinnedCells& cells, const Ball& ball,
                           const CodewordMembers& taken, LocalHistograms& histograms, Progress& progress);

/// Both histograms of about `wanted` cells of each block that is held, which stay there.
PackedHistograms sample_on_gpu(const Device& device, const HistogramData& data, HistogramPath path,
                               const BlockMap& blocks, double wanted, Progress& progress);

}  // namespace chiaro

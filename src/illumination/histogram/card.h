// What cards do of local histograms.
#pragma once
#include "illumination/histogram/card_source.h"
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/histograms.h"
#include "illumination/histogram/members.h"

namespace chiaro {

/// Identifiers of every node, which stay there too.
void assign_on_card(const Device& device, const HistogramData& data, HistogramPath path, const Codebook& book,
                    LocalHistograms& out, Progress& progress);

/// As find_words, from the members that were taken. Memory there: 16 bytes a bin of each, 1 GiB at most.
void find_words_on_card(const Device& device, const BinnedCells& cells, const Ball& ball, const WordMembers& taken,
                        LocalHistograms& histograms, Progress& progress);

/// Both histograms of about `wanted` cells of each block that is held, which stay there.
PackedHistograms sample_on_card(const Device& device, const HistogramData& data, HistogramPath path,
                                const BlockMap& blocks, double wanted, Progress& progress);

}  // namespace chiaro

// Local histograms of a volume: a codebook of full histograms, and two identifiers at every node.
#pragma once
#include <chiaro/lighting.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "illumination/cells/mirrored_buffer.h"
#include "illumination/histogram/cells.h"
#include "illumination/stage_timer.h"

namespace chiaro {

/// Identifiers of a node: the words for the half ball that ∇f points to, and for the other.
struct CodewordPair {
    std::uint16_t forward, backward;
};

struct LocalHistograms : std::enable_shared_from_this<LocalHistograms> {
    CellGrid grid;
    Binning binning;
    int radius = 0;     ///< cells
    int subsample = 1;  ///< node i lies at cell i × subsample
    std::array<int, 3> nodes{0, 0, 0};
    VoxelBuffer identifiers;  ///< CodewordPair a node, x fastest, and a spare one
    /// The same for pictures: forward from the node one further along ∇f, backward from the one before, where the
    /// gradient there is much the same; so a surface's own cells are not in its way.
    MirroredBuffer displaced{0};
    int codewords = 0, stride = 0;         ///< numbers from one word to the next: the bins, and up to 15 more
    std::vector<std::uint16_t> shares;     ///< LH_j of each word as parts of its scale; the largest is 65535
    std::vector<float> scale;              ///< of each word: LH_j = share × scale
    std::size_t histograms = 0;            ///< how many the words stand for
    std::vector<double> distortions = {};  ///< of training; empty when read from a cache
    std::shared_ptr<const char> life = std::make_shared<const char>();  ///< by which a GPU knows the identifiers

    std::size_t node_count() const { return std::size_t(nodes[0]) * std::size_t(nodes[1]) * std::size_t(nodes[2]); }
    std::span<const CodewordPair> pairs() const {
        return {reinterpret_cast<const CodewordPair*>(identifiers.data()), node_count()};
    }
    std::span<CodewordPair> pairs() { return {reinterpret_cast<CodewordPair*>(identifiers.data()), node_count()}; }
    std::size_t bytes() const {
        return identifiers.size() + displaced.size() + shares.size() * sizeof shares[0] +
               scale.size() * sizeof scale[0];
    }
};

/// All steps: bins, training, assignment fused with the histograms (which are never stored), words from unpacked
/// members. The same for any number of threads and instruction set. Throws Error{interrupted} when cancelled.
LocalHistograms find_local_histograms(const Device& device, const DeviceVolume::Data& volume,
                                      const HistogramSettings& settings, StageTimer& timer, Progress& progress);

/// Fills `displaced`.
void normal_offset_identifiers(const Device& device, const BinnedCells& cells, LocalHistograms& histograms);

}  // namespace chiaro

// Local histograms on a card: made there plane by plane, used there and forgotten.
#pragma once
#include "cuda/mirror.h"
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/fast.h"
#include "illumination/histogram/histograms.h"
#include "illumination/histogram/launch_card.h"
#include "illumination/histogram/members.h"

namespace chiaro {

/// As FastHistograms, on the device's card. Memory there: cells' bins, and for many blocks at once 1 GiB at most.
class CardHistograms {
public:
    CardHistograms(const Device& device, const HistogramData& data, int step);
    int bins() const { return shape_.block.bins; }

    using UsePlane = std::function<void(const kernel::HistogramPlane&, std::int64_t blocks)>;
    /// Calls use(plane, how many blocks) for every plane of the blocks that are held: every `step`th of its cells has
    /// histograms. A block comes before those above it, and from below its planes.
    void find(const BlockMap& map, std::string_view stage, Progress& progress, const UsePlane& use);

private:
    cuda::Stream& stream_;
    const FastShape shape_;
    const std::size_t room_bytes_, together_;
    const cuda::Array<std::uint32_t> code_;
    const cuda::Array<kernel::FastBlock> blocks_;
    cuda::Array<std::byte> room_;
    const cuda::Array<float> normals_;
    const cuda::Array<PackedHistogram> histograms_;
    kernel::FastBatch batch_{};
};

/// Identifiers of every node, which stay there too.
void assign_on_card(const Device& device, const HistogramData& data, const Codebook& book, LocalHistograms& out,
                    Progress& progress);

/// `lift` of every node, which stays there until the host reads it.
void lift_on_card(const Device& device, const BinnedCells& cells, kernel::LiftKernel lift, LocalHistograms& histograms);

/// As find_words, from the members that were taken. Memory there: 16 bytes a bin of each, 1 GiB at most.
void find_words_on_card(const Device& device, const BinnedCells& cells, const Ball& ball, const WordMembers& taken,
                        LocalHistograms& histograms, Progress& progress);

/// The histograms of cells of some blocks, in the order of `place`, where each of their cells has its own or -1.
std::vector<PackedHistogram> sample_on_card(const Device& device, const HistogramData& data, const BlockMap& blocks,
                                            const std::vector<std::int32_t>& place, std::size_t cells,
                                            Progress& progress);

}  // namespace chiaro

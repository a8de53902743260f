// Packed histograms on a GPU, where they are made, used and forgotten: one class for each path.
#pragma once
#include <optional>

#include "cuda/run.h"
#include "illumination/cells/gpu.h"
#include "illumination/histogram/launch_gpu.h"
#include "illumination/histogram/source.h"

namespace chiaro {

/// As HistogramSource, on the device's GPU: slabs of many blocks at a time. Memory there: cells' bins, and a quarter
/// of what was free, 8 GiB at most.
class GpuHistograms {
public:
    virtual ~GpuHistograms() = default;
    int bins() const { return slab_.bins; }
    std::size_t cells_together() const { return together_ * std::size_t(slab_.cells()); }  ///< of a slab

    using UseSlab = std::function<void(const kernel::HistogramSlab&, std::int64_t blocks)>;
    /// Calls use(slab, how many blocks) for all cells of the blocks that are held: nodes among them have histograms. A
    /// block comes before those above it, and from below its slabs.
    void find(const BlockMap& map, std::string_view stage, Progress& progress, const UseSlab& use);

protected:
    /// `step`: cells from one node to the next; bytes_of(planes): what a block needs beside its histograms.
    GpuHistograms(const Device& device, const HistogramData& data, int step,
                  const std::function<std::size_t(int)>& bytes_of);

    /// What blocks need before their slabs; then the histograms of one.
    virtual void begin(const kernel::HistogramSlab&, std::int64_t) {}
    virtual void fill(const kernel::HistogramSlab& slab, std::int64_t blocks) = 0;

    cuda::Stream& stream_;
    std::size_t together_;        ///< blocks
    kernel::HistogramSlab slab_;  ///< as they all are

private:
    void share_out(std::size_t memory, const std::function<std::size_t(int)>& bytes_of);
    std::optional<cuda::Array<PackedHistogram>> histograms_;
};

std::unique_ptr<GpuHistograms> make_gpu_histograms(const Device& device, const HistogramData& data, HistogramPath path,
                                                   int step);

}  // namespace chiaro

// Histograms of blocks by sums over boxes, on a GPU.
#pragma once
#include "illumination/histogram/fast.h"
#include "illumination/histogram/gpu_source.h"

namespace chiaro {

/// As FastHistograms.
class GpuFastHistograms : public GpuHistograms {
public:
    GpuFastHistograms(const Device& device, const HistogramData& data, int step)
        : GpuFastHistograms(device, data, step, FastShape(data.packing, data.radius)) {}

private:
    GpuFastHistograms(const Device& device, const HistogramData& data, int step, FastShape shape);
    void begin(const kernel::HistogramSlab& slab, std::int64_t blocks) override;
    void fill(const kernel::HistogramSlab& slab, std::int64_t blocks) override;

    const FastShape shape_;
    const cuda::Array<std::uint32_t> code_;
    const cuda::Array<kernel::FastBlock> blocks_;
    cuda::Array<std::byte> workspace_;
    const cuda::Array<float> normals_;
    kernel::FastBatch batch_{};
};

}  // namespace chiaro

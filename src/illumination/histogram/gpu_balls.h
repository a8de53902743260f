// Histograms by brute force and of moving balls, on a GPU.
#pragma once
#include "illumination/histogram/ball.h"
#include "illumination/histogram/gpu_source.h"
#include "illumination/histogram/slab_source.h"

namespace chiaro {

/// As HistogramPath::exact: room for the places of all cells of a slab, eight numbers each.
class GpuExactHistograms : public GpuHistograms {
public:
    GpuExactHistograms(const Device& device, const HistogramData& data, int step);

private:
    void fill(const kernel::HistogramSlab& slab, std::int64_t blocks) override;

    const Ball ball_;
    const cuda::Array<std::uint16_t> places_;
    cuda::Array<float> counts_;
    const cuda::Array<float> packed_;
    cuda::Views views_;
    kernel::CountSlab count_{};
    kernel::PackSlab pack_{};
};

/// As SweptHistograms.
class GpuSweptHistograms : public GpuHistograms {
public:
    GpuSweptHistograms(const Device& device, const HistogramData& data, int step);

private:
    void fill(const kernel::HistogramSlab& slab, std::int64_t blocks) override;

    const Ball ball_;
    const cuda::Array<std::int32_t> counts_;
    cuda::Views views_;
    kernel::SweepSlab sweep_{};
};

}  // namespace chiaro

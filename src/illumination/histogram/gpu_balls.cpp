#include "illumination/histogram/gpu_balls.h"

#include "illumination/histogram/sweep.h"

namespace chiaro {
namespace {

using kernel::HistogramSlab;

/// Those of a histogram by brute force: packed bins at once where every bin goes to one.
int places_of(const HistogramData& data) {
    return data.packing.is_one_to_one() ? data.packing.packed : data.cells.binning.count;
}

HostArrays arrays_of(const Ball& ball, const Packing& packing) {
    HostArrays arrays;
    arrays.add(ball.rows), arrays.add(ball.weights);
    arrays.add(packing.low), arrays.add(packing.share);
    return arrays;
}

}  // namespace

GpuExactHistograms::GpuExactHistograms(const Device& device, const HistogramData& data, int step)
    : GpuHistograms(device, data, step,
                    [&](int planes) {
                        const int numbers = 2 * (4 * places_of(data) + padded_bins(data.packing.packed));
                        return std::size_t(planes) * HistogramSlab::plane * std::size_t(numbers) * sizeof(float);
                    }),
      ball_(data.radius, true),
      places_(stream_, data.packing.is_one_to_one() ? data.cells.grid.size() : 1),
      counts_(stream_, cells_together() * 8 * std::size_t(places_of(data))),
      packed_(stream_, cells_together() * 2 * std::size_t(bins())),
      views_(stream_, arrays_of(ball_, data.packing)) {
    count_.ball = ball_.view(), pack_.packing = data.packing.view();
    views_.to_device_pointers(count_.ball.row, count_.ball.weights, pack_.packing.low, pack_.packing.share);
    count_.places = slab_.grid.bins;
    count_.count = pack_.count = places_of(data);
    count_.counts = counts_.data(), pack_.counts = counts_.data(), pack_.packed = packed_.data();
    if (!data.packing.is_one_to_one()) return;
    kernel::run_on_gpu(stream_, std::int64_t(places_.size()),
                       kernel::PlaceCells{slab_.grid.bins, pack_.packing.low, places_.data()});
    count_.places = places_.data(), pack_.packing = {};
}

void GpuExactHistograms::fill(const HistogramSlab& slab, std::int64_t blocks) {
    count_.slab = pack_.slab = slab;
    counts_.zero();
    kernel::run_on_gpu(stream_, blocks * slab.cells() * 2, count_);
    kernel::run_on_gpu(stream_, blocks * slab.cells() * 2, pack_);
}

GpuSweptHistograms::GpuSweptHistograms(const Device& device, const HistogramData& data, int step)
    : GpuHistograms(device, data, step,
                    [&](int planes) {
                        const std::size_t rows = std::size_t(planes) * HistogramSlab::edge;
                        return rows * std::size_t(padded_bins(data.packing.packed)) * sizeof(std::int32_t);
                    }),
      ball_(data.radius, false),
      counts_(stream_, cells_together() / HistogramSlab::edge * std::size_t(bins())),
      views_(stream_, arrays_of(ball_, data.packing)) {
    sweep_.row = swept_row(slab_.grid, data.packing, ball_);
    views_.to_device_pointers(sweep_.row.ball.row, sweep_.row.ball.weights, sweep_.row.packing.low,
                              sweep_.row.packing.share);
    sweep_.counts = counts_.data();
}

void GpuSweptHistograms::fill(const HistogramSlab& slab, std::int64_t blocks) {
    sweep_.slab = slab;
    kernel::run_on_gpu(stream_, blocks * slab.cells() / HistogramSlab::edge, sweep_);
}

}  // namespace chiaro

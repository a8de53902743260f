#include "illumination/histogram/source.h"

#include "illumination/histogram/exact.h"
#include "illumination/histogram/exact_kernel.h"
#include "illumination/histogram/fast.h"
#include "illumination/histogram/sweep.h"

namespace chiaro {
namespace {

/// Brute force, then packed: at once where every bin goes to one packed bin.
class ExactSource : public HistogramSource {
public:
    ExactSource(const Device& device, const BinnedCells& cells, const Packing& packing, int radius)
        : HistogramSource(cells, padded_bins(packing.packed)),
          packing_(packing),
          packs_at_once_(packing.is_one_to_one()),
          ball_(radius, true),
          exact_(packs_at_once_ ? ExactHistograms(device, cells, ball_, packing.low, packing.packed)
                                : ExactHistograms(device, cells, ball_)) {}

    void find(std::size_t block, int step, const Wanted& wanted, const UseRow& use_row) const override {
        std::vector<PackedHistogram> histograms(std::size_t(2 * block_edge * bins_));
        for_rows(block, step, wanted, [&](const std::pair<int, int>& x, int y, int z) {
            find_row(x, y, z, step, histograms.data());
            use_row(y, z, histograms.data());
        });
    }

private:
    void find_row(const std::pair<int, int>& range, int y, int z, int step, PackedHistogram* to) const {
        const auto places = std::size_t(exact_.places());
        std::vector<float> found(2 * places), packed(std::size_t(packing_.packed));
        for (int x = range.first; x < range.second; x += step) {
            exact_.find(x, y, z, found.data());
            for (const std::size_t half : {0, 1}) {
                const std::span<const float> histogram(found.data() + half * places, places);
                if (packs_at_once_)
                    std::copy(histogram.begin(), histogram.end(), packed.begin());
                else
                    packing_.pack(histogram, packed);
                std::fill_n(to, bins_, PackedHistogram(0));
                for (std::size_t k = 0; k < packed.size(); ++k) to[k] = kernel::packed_share(packed[k]);
                to += bins_;
            }
        }
    }

    const Packing& packing_;
    const bool packs_at_once_;
    const Ball ball_;
    const ExactHistograms exact_;
};

}  // namespace

std::unique_ptr<HistogramSource> make_source(const Device& device, const HistogramData& data, HistogramPath path) {
    switch (path) {
        case HistogramPath::sweep:
            return std::make_unique<SweptHistograms>(data.cells, data.packing, data.radius);
        case HistogramPath::exact:
            return std::make_unique<ExactSource>(device, data.cells, data.packing, data.radius);
        default:
            return std::make_unique<FastHistograms>(device, data.cells, data.packing, data.radius);
    }
}

}  // namespace chiaro

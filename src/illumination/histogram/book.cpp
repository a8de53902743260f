#include <algorithm>
#include <numeric>

#include "core/threads.h"
#include "cuda/run.h"
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/launch.h"
#include "illumination/histogram/nearest_kernel.h"
#include "illumination/histogram/neighbour_kernel.h"

namespace chiaro {

Codebook::Codebook(const Device& device, int bins, HistogramMetric metric, std::vector<PackedHistogram> words)
    : bins_(bins), metric_(metric), words_(std::move(words)) {
    listed_ = std::min(count() - 1, most_listed);
    const std::size_t listed = std::size_t(count()) * std::size_t(std::max(listed_, 1));  // a card has no empty arrays
    neighbours_ = TwinBuffer(listed * sizeof(std::uint16_t)), distances_ = TwinBuffer(listed * sizeof(float));
    if (!cuda::done_on_card(device, [&] { list_on_card(device); })) list_neighbours(device);
}

void Codebook::list_neighbours(const Device& device) {
    auto* const neighbours = reinterpret_cast<std::uint16_t*>(neighbours_.data());
    auto* const distances = reinterpret_cast<float*>(distances_.data());
    const auto kernels = kernel::histogram_functions_for(device.isa);
    const kernel::CodebookView book = view();
    parallel_for(device.threads, count(), 32, [&](std::int64_t first, std::int64_t end) {
        std::vector<std::int32_t> difference(std::size_t(count()), 0);
        std::vector<std::uint16_t> order;
        for (auto w = first; w < end; ++w) {
            kernels.differences_to(book, words_.data() + w * bins_, difference.data());
            order.resize(std::size_t(count()));
            std::iota(order.begin(), order.end(), std::uint16_t(0));
            order.erase(order.begin() + w);
            const auto nearer = [&](std::uint16_t a, std::uint16_t b) {
                return difference[a] != difference[b] ? difference[a] < difference[b] : a < b;
            };
            std::nth_element(order.begin(), order.begin() + listed_, order.end(), nearer);
            std::sort(order.begin(), order.begin() + listed_, nearer);
            for (int i = 0; i < listed_; ++i) {
                const std::size_t at = std::size_t(w) * std::size_t(listed_) + std::size_t(i);
                neighbours[at] = order[std::size_t(i)];
                distances[at] = kernel::distance_of(book, difference[order[std::size_t(i)]]);
            }
        }
    });
}

/// Without sorting: every place is found by itself.
void Codebook::list_on_card(const Device& device) {
    cuda::Stream& stream = *device.stream;
    const std::int64_t pairs = std::int64_t(count()) * count();
    const cuda::Array<std::int32_t> differences(stream, std::size_t(pairs));
    const cuda::Array<std::byte> neighbours(stream, neighbours_.size()), distances(stream, distances_.size());
    const kernel::CodebookView book = view_of(words_on_card(stream), nullptr, nullptr);
    kernel::run_on_card(stream, pairs, kernel::WordDifferences{book, differences.data()});
    kernel::run_on_card(
        stream, pairs,
        kernel::RankNeighbours{book, differences.data(), reinterpret_cast<std::uint16_t*>(neighbours.data()),
                               reinterpret_cast<float*>(distances.data())});
    neighbours_.keep(device.stream, neighbours.data());
    distances_.keep(device.stream, distances.data());
}

const PackedHistogram* Codebook::words_on_card(cuda::Stream& stream) const {
    return reinterpret_cast<const PackedHistogram*>(stream.mirror()->of(HostArray::of(life_, words_), stream));
}

kernel::CodebookView Codebook::view_of(const PackedHistogram* words, const std::byte* neighbours,
                                       const std::byte* distances) const {
    return {words,
            count(),
            bins_,
            kernel::CodebookMetric(metric_),
            reinterpret_cast<const std::uint16_t*>(neighbours),
            reinterpret_cast<const float*>(distances),
            std::int32_t(listed_)};
}

kernel::CodebookView Codebook::view() const { return view_of(words_.data(), neighbours_.data(), distances_.data()); }

kernel::CodebookView Codebook::view_on_card(cuda::Stream& stream) const {
    return view_of(words_on_card(stream), neighbours_.on_card(stream), distances_.on_card(stream));
}

}  // namespace chiaro

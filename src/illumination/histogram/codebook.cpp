#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "core/threads.h"
#include "cuda/run.h"
#include "illumination/histogram/codebook.h"
#include "illumination/histogram/launch.h"
#include "illumination/histogram/nearest_kernel.h"
#include "illumination/histogram/neighbour_kernel.h"

namespace chiaro {
namespace {

/// At least `wanted` of the numbers, none below 0, are not above it, and few more. By counting their leading bits.
std::int32_t bound_of_least(const std::vector<std::int32_t>& numbers, int wanted) {
    constexpr int shift = 19;  // of a float: sign, exponent and four bits of the fraction
    std::array<int, std::size_t(1) << (31 - shift)> counts{};
    const auto bits = [](std::int32_t number) { return std::bit_cast<std::uint32_t>(float(number)) >> shift; };
    for (const std::int32_t number : numbers) ++counts[bits(number)];
    std::uint32_t last = 0;
    for (int found = counts[0]; found < wanted; found += counts[last]) ++last;
    const float above = std::bit_cast<float>((last + 1) << shift);
    return above < 2147483648.0f ? std::int32_t(above) : std::numeric_limits<std::int32_t>::max();
}

}  // namespace

Codebook::Codebook(const Device& device, int bins, HistogramMetric metric, std::vector<PackedHistogram> codewords)
    : bins_(bins), metric_(metric), codewords_(std::move(codewords)) {
    listed_ = std::min(count() - 1, max_listed);
    const std::size_t listed = std::size_t(count()) * std::size_t(std::max(listed_, 1));  // a GPU has no empty arrays
    neighbours_ = MirroredBuffer(listed * sizeof(std::uint16_t)), distances_ = MirroredBuffer(listed * sizeof(float));
    if (!cuda::try_gpu(device, [&] { list_on_gpu(device); })) list_neighbours(device);
}

void Codebook::list_neighbours(const Device& device) {
    auto* const neighbours = reinterpret_cast<std::uint16_t*>(neighbours_.data());
    auto* const distances = reinterpret_cast<float*>(distances_.data());
    const auto kernels = kernel::histogram_functions_for(device.isa);
    const kernel::CodebookView codebook = view();
    parallel_for(device.threads, count(), 32, [&](std::int64_t first, std::int64_t end) {
        std::vector<std::int32_t> difference(std::size_t(count()), 0);
        std::vector<std::uint64_t> order;  // by difference, then by number
        for (auto w = first; w < end; ++w) {
            kernels.differences_to(codebook, codewords_.data() + w * bins_, difference.data());
            difference[std::size_t(w)] = std::numeric_limits<std::int32_t>::max();  // itself is none
            const std::int32_t most = bound_of_least(difference, listed_);
            order.clear();
            for (int other = 0; other < count(); ++other)
                if (difference[std::size_t(other)] <= most)
                    order.push_back(std::uint64_t(difference[std::size_t(other)]) << 16 | unsigned(other));
            std::sort(order.begin(), order.end());
            for (int i = 0; i < listed_; ++i) {
                const std::size_t at = std::size_t(w) * std::size_t(listed_) + std::size_t(i);
                neighbours[at] = std::uint16_t(order[std::size_t(i)]);
                distances[at] = kernel::distance_of(codebook, std::int32_t(order[std::size_t(i)] >> 16));
            }
        }
    });
}

/// Without sorting: every place is found by itself.
void Codebook::list_on_gpu(const Device& device) {
    cuda::Stream& stream = *device.stream;
    const std::int64_t pairs = std::int64_t(count()) * count();
    const cuda::Array<std::int32_t> differences(stream, std::size_t(pairs));
    const cuda::Array<std::byte> neighbours(stream, neighbours_.size()), distances(stream, distances_.size());
    const kernel::CodebookView codebook = view_of(codewords_on_gpu(stream), nullptr, nullptr);
    kernel::run_on_gpu(stream, pairs, kernel::CodewordDifferences{codebook, differences.data()});
    kernel::run_on_gpu(
        stream, pairs,
        kernel::RankNeighbours{codebook, differences.data(), reinterpret_cast<std::uint16_t*>(neighbours.data()),
                               reinterpret_cast<float*>(distances.data())});
    neighbours_.keep(device.stream, neighbours.data());
    distances_.keep(device.stream, distances.data());
}

const PackedHistogram* Codebook::codewords_on_gpu(cuda::Stream& stream) const {
    return reinterpret_cast<const PackedHistogram*>(
        stream.device_cache()->of(HostArray::of(life_, codewords_), stream));
}

kernel::CodebookView Codebook::view_of(const PackedHistogram* codewords, const std::byte* neighbours,
                                       const std::byte* distances) const {
    return {codewords,
            count(),
            bins_,
            kernel::CodebookMetric(metric_),
            reinterpret_cast<const std::uint16_t*>(neighbours),
            reinterpret_cast<const float*>(distances),
            std::int32_t(listed_)};
}

kernel::CodebookView Codebook::view() const {
    return view_of(codewords_.data(), neighbours_.data(), distances_.data());
}

kernel::CodebookView Codebook::view_on_gpu(cuda::Stream& stream) const {
    return view_of(codewords_on_gpu(stream), neighbours_.on_gpu(stream), distances_.on_gpu(stream));
}

}  // namespace chiaro

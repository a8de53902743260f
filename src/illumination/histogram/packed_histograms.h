// Packed histograms one after the other, which a GPU may have made.
#pragma once
#include <cstring>
#include <vector>

#include "illumination/cells/mirrored_buffer.h"
#include "illumination/histogram/codebook_view.h"

namespace chiaro {

/// Packed histograms are vectors of 16-bit numbers, packed_one for 1, as long as a multiple of 16.
using PackedHistogram = std::int16_t;
using kernel::packed_one;
constexpr int padded_bins(int packed) { return (packed + 15) / 16 * 16; }

/// What a GPU made stays there until the host reads it.
struct PackedHistograms {
    MirroredBuffer buffer;

    explicit PackedHistograms(std::size_t numbers) : buffer(numbers * sizeof(PackedHistogram)) {}
    PackedHistograms(const std::vector<PackedHistogram>& list) : PackedHistograms(list.size()) {
        std::memcpy(buffer.data(), list.data(), buffer.size());
    }
    std::size_t size() const { return buffer.size() / sizeof(PackedHistogram); }  ///< numbers
    const PackedHistogram* data() const { return reinterpret_cast<const PackedHistogram*>(buffer.data()); }
    const PackedHistogram* on_gpu(cuda::Stream& stream) const {
        return reinterpret_cast<const PackedHistogram*>(buffer.on_gpu(stream));
    }
};

}  // namespace chiaro

// What all threads of a kernel count together, and its way to the host beside what they made.
#pragma once
#include <cstdint>
#include <cstring>

#include "cuda/stream.h"

namespace chiaro::cuda {

using Count = unsigned long long;
inline constexpr std::int32_t count_places = 1024;  ///< so many that threads do not wait for each other

class Counters {
public:
    explicit Counters(Stream& stream) : stream_(stream), places_(stream, count_places) { places_.zero(); }

    Count* data() const { return places_.data(); }  ///< for count() of cuda/launch.h
    /// Waits until `bytes` have come from the card; the sum of what was counted till then.
    std::uint64_t land(void* to, const void* from, std::size_t bytes) const {
        std::byte* landed = stream_.landing(bytes + sizeof(Count[count_places]));
        stream_.download(landed, from, bytes);
        stream_.download(landed + bytes, places_.data(), sizeof(Count[count_places]));
        stream_.wait();
        std::memcpy(to, landed, bytes);
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < count_places; ++i) {
            Count place;
            std::memcpy(&place, landed + bytes + i * sizeof place, sizeof place);
            sum += place;
        }
        return sum;
    }

private:
    Stream& stream_;
    Array<Count> places_;
};

}  // namespace chiaro::cuda

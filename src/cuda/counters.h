// What all threads of a kernel count together.
#pragma once
#include <array>
#include <cstdint>
#include <numeric>

#include "cuda/stream.h"

namespace chiaro::cuda {

using Count = unsigned long long;
inline constexpr std::int32_t count_places = 1024;  ///< so many that threads do not wait for each other

class Counters {
public:
    explicit Counters(Stream& stream) : stream_(stream), places_(stream, count_places) { places_.zero(); }

    Count* data() const { return places_.data(); }  ///< for count() of cuda/launch.h
    /// Waits; the sum of what was counted till then.
    std::uint64_t sum() const {
        std::array<Count, count_places> counted;
        stream_.fetch(counted.data(), places_.data(), sizeof counted);
        return std::accumulate(counted.begin(), counted.end(), std::uint64_t(0));
    }

private:
    Stream& stream_;
    Array<Count> places_;
};

}  // namespace chiaro::cuda

// What a picture file may promise.
#pragma once
#include <cstdint>

namespace chiaro {

/// Larger images are refused before memory is taken for them.
inline constexpr std::int64_t max_pixels = 100'000'000;

}  // namespace chiaro

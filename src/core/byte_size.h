// Sizes as people write them.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace chiaro {

/// Bytes of "4G", "1.5M", "512K" (powers of 1024) or "1000"; none for anything else, and beyond 2^50.
std::optional<std::uint64_t> bytes_from(std::string_view text);

}  // namespace chiaro

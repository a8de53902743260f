// Castagnoli's checksum (RFC 3720, B.4), eight bytes at a time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace chiaro {

/// Of `bytes`, one behind the other; gigabytes a second.
std::uint32_t crc32c(std::span<const std::byte> bytes);

}  // namespace chiaro

// Castagnoli's checksum (RFC 3720, B.4), eight bytes at a time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace chiaro {

/// Of `bytes`, one behind the other, by the processor's own instruction where it has one; gigabytes a second.
std::uint32_t crc32c(std::span<const std::byte> bytes);
/// The same by tables, a fifth as fast.
std::uint32_t crc32c_by_tables(std::span<const std::byte> bytes);

}  // namespace chiaro

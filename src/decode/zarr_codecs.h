// What chunks are compressed by.
#pragma once
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace chiaro::decode {

enum class Codec { deflate, zstd, lz4, blosc, crc32c };

/// The codec of this name, of version 2 or 3. Throws Error{input} for one that is not read.
Codec codec_named(const std::string& name);

/// Undoes the codecs, the last one first: `to` is what is there in the end. `spare` is room that is used again. Throws
/// Error{input} where the bytes are damaged or of another number.
void unpack(const std::vector<Codec>& codecs, std::vector<std::byte>& from, std::span<std::byte> to,
            std::vector<std::byte>& spare);

/// The most bytes that so many can have become when they were packed by any of them.
constexpr std::uint64_t largest_packed(std::uint64_t bytes) { return bytes + bytes / 8 + (1 << 16); }

/// Little endian.
std::uint64_t number_at(const std::byte* from, std::size_t bytes);

}  // namespace chiaro::decode

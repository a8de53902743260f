// Bytes of a file from an offset, inflated on the way where they are compressed.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace chiaro::decode {

class ByteSource {
public:
    virtual ~ByteSource() = default;
    /// Fills `to` and returns how much was there: less than asked for only at the end. Throws Error{input} where the
    /// file cannot be read or its compressed stream is damaged.
    virtual std::size_t read(std::span<std::byte> to) = 0;
};

/// The bytes as they lie in the file. Throws Error{input} for what is not a regular file.
std::unique_ptr<ByteSource> open_plain(const std::filesystem::path& path, std::uint64_t offset = 0);

/// A gzip or zlib stream, of any number of members.
std::unique_ptr<ByteSource> open_deflated(const std::filesystem::path& path, std::uint64_t offset = 0);

/// Reads and forgets. Throws Error{input} when fewer bytes are there.
void skip(ByteSource& source, std::uint64_t bytes);

/// Size in bytes of a regular file. Throws Error{input} for anything else, without opening it (a FIFO would wait).
std::uint64_t regular_file_size(const std::filesystem::path& path);

/// Deflate cannot turn one byte into more than this many.
constexpr std::uint64_t largest_deflate_ratio = 1032;

}  // namespace chiaro::decode

// A picture file as it is.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace chiaro {

/// Larger images are refused before memory is taken for them.
inline constexpr std::int64_t max_pixels = 100'000'000;

/// At most 2 GiB. Throws Error{input} that names the file and the reason.
std::vector<std::byte> file_bytes(const std::filesystem::path& path);

}  // namespace chiaro

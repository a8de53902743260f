// Whole files: the one place where the program opens scenes, transfer functions, pictures, lists and caches. Volumes
// are chiaro-decode's.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace chiaro {

inline constexpr std::uintmax_t max_file_bytes = 2048u << 20;

/// Of a regular file only: a FIFO or a device is refused, and never waited for. Throws Error{input} that names the file
/// and the reason, with "did you mean" where it is not there.
std::vector<std::byte> file_bytes(const std::filesystem::path& path, std::uintmax_t max_bytes = max_file_bytes);
std::string file_text(const std::filesystem::path& path, std::uintmax_t max_bytes);
/// The first bytes of a file, all of them where it has no more.
std::string file_beginning(const std::filesystem::path& path, std::uintmax_t bytes);

}  // namespace chiaro

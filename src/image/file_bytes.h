// A picture file as it is.
#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

namespace chiaro {

/// At most 2 GiB. Throws Error{input} that names the file and the reason.
std::vector<std::byte> file_bytes(const std::filesystem::path& path);

}  // namespace chiaro

// The files that a scene names.
#pragma once
#include <filesystem>
#include <string>

namespace chiaro {

/// Whether there is such a file; no access counts as none.
bool is_file(const std::filesystem::path& path);

/// The path that a name in a scene stands for: beside the scene, else in the data folder, else beside the scene again.
/// `sample:NAME` and `-` stand for themselves; `file.h5:/path/to/dataset` is looked up by its first part.
std::string found_file(const std::string& name, const std::filesystem::path& folder,
                       const std::filesystem::path& data_folder);

/// The same for a transfer function, FILE or FILE#FUNCTION.
std::string found_function(const std::string& name, const std::filesystem::path& folder,
                           const std::filesystem::path& data_folder);

}  // namespace chiaro

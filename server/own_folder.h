// A folder of this program's own below another: locked as long as the program lives, removed with it.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace chiaro::server {

/// A new folder and its lock. Throws Error{output}.
std::pair<std::filesystem::path, int> make_own_folder(const std::filesystem::path& parent);
/// Removes the folders below `parent` whose programs have ended without a chance to, but for those that `is_kept`:
/// these are returned, and this program's own from now on.
std::vector<std::pair<std::filesystem::path, int>> remove_left_behind(
    const std::filesystem::path& parent, const std::function<bool(const std::filesystem::path&)>& is_kept = {});

}  // namespace chiaro::server

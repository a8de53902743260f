// Where the user's own cache is.
#pragma once
#include <cstdlib>
#include <filesystem>

namespace chiaro {

/// What local histograms that are kept there end with.
inline constexpr const char* histograms_ending = ".histograms";

/// $XDG_CACHE_HOME/chiaro or ~/.cache/chiaro; empty where neither is known.
inline std::filesystem::path user_cache() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
        return std::filesystem::path(cache) / "chiaro";
    const char* home = std::getenv("HOME");
    return home && *home ? std::filesystem::path(home) / ".cache" / "chiaro" : std::filesystem::path();
}

}  // namespace chiaro

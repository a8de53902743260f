// Prepared volumes kept between runs, one file each.
#pragma once
#include <chiaro/lighting.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "illumination/histogram/histograms.h"

namespace chiaro {

/// What stands behind the key of a cache file, its checksum included (which is looked at before): nothing unless it is
/// consistent in itself.
std::optional<LocalHistograms> parse_local_histograms(std::span<const std::byte> body);

/// Files are named by the hash of their key, which holds the data's hash and every parameter that matters; they are
/// written whole or not at all, and end with a checksum.
class HistogramCache {
public:
    /// `folder` as in HistogramSettings::cache: "" is $XDG_CACHE_HOME/chiaro or ~/.cache/chiaro, "none" keeps nothing.
    HistogramCache(const std::string& folder, const DeviceVolume::Data& volume, const HistogramSettings& settings);

    /// What was kept, all but what is read at a normal offset. A file that is damaged is told in `notes`.
    std::optional<LocalHistograms> read(std::vector<std::string>& notes) const;
    /// A file that cannot be written is told in `notes`.
    void write(const LocalHistograms& histograms, std::vector<std::string>& notes) const;

    const std::filesystem::path& path() const { return path_; }  ///< empty: nothing is kept

private:
    std::filesystem::path path_;
    std::string key_;
};

}  // namespace chiaro

// Volumes of any size to a store that is read brick by brick.
#pragma once
#include <chiaro/brick_source.h>
#include <chiaro/export.h>
#include <chiaro/progress.h>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

namespace chiaro {

/// How chunks are packed: not at all; by zstd; by blosc, which is LZ4 after a shuffle of bits or bytes.
enum class ZarrEncoding { raw, zstd, blosc };
/// What a voxel of a coarser level is of those that it stands for.
enum class LevelsBy { mean, max };

struct ZarrSettings {
    std::optional<ZarrEncoding> encoding;  ///< not set: zstd of 8 bits, blosc of wider numbers
    LevelsBy levels_by = LevelsBy::mean;
};

constexpr auto names_of(ZarrEncoding) { return std::to_array<std::string_view>({"raw", "zstd", "blosc"}); }
constexpr auto names_of(LevelsBy) { return std::to_array<std::string_view>({"mean", "max"}); }

/// Writes OME-Zarr 0.5: level 0 of the source, and levels of half the voxels an axis (of axes whose voxels are not
/// twice as wide as others already) down to 64, the means (rounded to the nearest, of floats that are numbers) or the
/// maxima of what they stand for. Chunks of 64³, each with a checksum (CRC-32C), lie in shards of 16 million voxels,
/// each written whole or not at all. `folder` becomes a store with its last file; until then it holds what is done, and
/// the same call goes on there: the bytes in the end are the same. What OME-Zarr has no place for - orientation, slope
/// and intercept - stands in the attribute "chiaro", which `read_volume` knows. Takes the memory of a few shards.
/// Reported as "write". Throws Error{output} where the folder is there already, or holds the beginning of another
/// volume, or cannot be written; Error{input} as BrickSource::read; Error{interrupted} when cancelled.
CHIARO_EXPORT void write_zarr(const BrickSource& source, const std::filesystem::path& folder,
                              const ZarrSettings& settings, Progress& progress);

/// A volume in memory as a source of one level. Of numbers wider than 16 bits floats are kept. Throws Error{input} for
/// several values a voxel.
CHIARO_EXPORT std::shared_ptr<const BrickSource> source_of(Volume volume);

}  // namespace chiaro
